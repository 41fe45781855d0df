#include "eval/render/hall_file.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "eval/dataset/sensor_table.h"
#include "eval/files/csv_text.h"
#include "eval/files/output_file.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::array<const char*, 6> kNumbers = {"x_0", "y_0", "z_0", "x_1", "y_1", "z_1"};

std::string Row(const char* shape, const Vector3d& first, const Vector3d& second) {
  std::vector<std::string> fields = {shape};
  for (const Vector3d& corner : {first, second}) {
    for (int axis = 0; axis < 3; ++axis) {
      fields.push_back(CsvNumber(corner[axis]));
    }
  }
  return JoinCsv(fields);
}

std::string BoxRow(const char* shape, const HallBox& box) {
  return Row(shape, box.low.cast<double>(), box.high.cast<double>());
}

struct HallRow {
  std::string shape;
  Vector3d first = Vector3d::Zero();
  Vector3d second = Vector3d::Zero();
};

Result<HallRow> ReadRow(const CsvReader& csv) {
  ALIDADE_RETURN_IF_ERROR(csv.ExpectColumns(kNumbers.size() + 1));
  HallRow row;
  row.shape = csv.field(0);
  for (std::size_t i = 0; i < kNumbers.size(); ++i) {
    Vector3d& corner = i < 3 ? row.first : row.second;
    ALIDADE_RETURN_IF_ERROR(csv.ReadReal(i + 1, kNumbers[i], &corner[static_cast<Eigen::Index>(i % 3)]));
  }
  return row;
}

Status SetEpoch(const CsvReader& csv, const HallRow& row, Hall* hall) {
  constexpr double kMostS = 9e9;  // an int64 of nanoseconds ends there
  const double seconds = row.first.x(), nanoseconds = row.first.y();
  if (seconds != std::floor(seconds) || std::abs(seconds) > kMostS) {
    return csv.Fault(1, "x_0", "whole seconds of a stamp");
  }
  if (nanoseconds != std::floor(nanoseconds) || nanoseconds < 0 || nanoseconds >= 1e9) {
    return csv.Fault(2, "y_0", "the nanoseconds that remain, a whole number from 0 to 999999999");
  }
  hall->epoch_ns = static_cast<TimeNs>(seconds) * kSecondNs + static_cast<TimeNs>(nanoseconds);
  return Status::Ok();
}

/// The row after a moving box: how it moves.
Status SetTravel(const CsvReader& csv, const HallRow& row, Hall* hall) {
  if (hall->moving.empty() || hall->moving.back().period_s > 0) {
    return csv.Fault(0, "shape", "travel only after a row moving");
  }
  if (!(static_cast<float>(row.second.x()) > 0)) {
    return csv.Fault(4, "x_1", "a period greater than 0");
  }
  MovingBox& moving = hall->moving.back();
  moving.travel = row.first.cast<float>();
  moving.period_s = static_cast<float>(row.second.x());
  moving.phase = static_cast<float>(row.second.y());
  return Status::Ok();
}

Status AddRow(const CsvReader& csv, const HallRow& row, Hall* hall) {
  if (row.shape == "origin") {
    hall->origin_W = row.first;
  } else if (row.shape == "epoch") {
    return SetEpoch(csv, row, hall);
  } else if (row.shape == "travel") {
    return SetTravel(csv, row, hall);
  } else if (row.shape == "room" || row.shape == "box" || row.shape == "moving") {
    if (!((row.second - row.first).minCoeff() > 0)) {
      return csv.Fault(4, "x_1", "the upper corner behind the lower one on every axis");
    }
    HallBox box;
    box.low = row.first.cast<float>();
    box.high = row.second.cast<float>();
    if (row.shape == "room") {
      hall->room = box;
    } else if (row.shape == "moving") {
      hall->moving.push_back({.box = box, .travel = Vector3f::Zero(), .period_s = 0, .phase = 0});
    } else {
      hall->boxes.push_back(box);
    }
  } else if (row.shape == "column") {
    if (!(row.second.x() > 0)) {
      return csv.Fault(4, "x_1", "a radius greater than 0");
    }
    HallColumn column;
    column.centre = row.first.head<2>().cast<float>();
    column.radius = static_cast<float>(row.second.x());
    hall->columns.push_back(column);
  } else {
    return csv.Fault(0, "shape", "origin, epoch, room, box, column, moving or travel");
  }
  return Status::Ok();
}

}  // namespace

std::string HallPath(const std::string& sequence) {
  return sequence + "/mav0/cam0/hall.csv";
}

std::string CameraPosesPath(const std::string& sequence) {
  return sequence + "/mav0/cam0/data_pose.csv";
}

Status WriteHall(const Hall& hall, const std::string& path) {
  std::string text = "#shape,x_0 [m],y_0 [m],z_0 [m],x_1 [m],y_1 [m],z_1 [m]\n";
  text += Row("origin", hall.origin_W, Vector3d::Zero()) + BoxRow("room", hall.room);
  for (const HallBox& box : hall.boxes) {
    text += BoxRow("box", box);
  }
  for (const HallColumn& column : hall.columns) {
    const Eigen::Vector2d axis = column.centre.cast<double>();
    text += Row("column", {axis.x(), axis.y(), 0}, {static_cast<double>(column.radius), 0, 0});
  }
  if (!hall.moving.empty()) {
    // Floored, so that the remainder is never negative.
    const TimeNs seconds = hall.epoch_ns / kSecondNs - (hall.epoch_ns % kSecondNs < 0 ? 1 : 0);
    text += Row("epoch",
                {static_cast<double>(seconds), static_cast<double>(hall.epoch_ns - seconds * kSecondNs), 0},
                Vector3d::Zero());
  }
  for (const MovingBox& moving : hall.moving) {
    text += BoxRow("moving", moving.box);
    text += Row("travel", moving.travel.cast<double>(),
                {static_cast<double>(moving.period_s), static_cast<double>(moving.phase), 0});
  }
  return WriteFileAtomically(path, text);
}

Result<Hall> ReadHall(const std::string& path) {
  std::vector<CsvColumn> header = {{"shape"}};
  for (const char* name : kNumbers) {
    header.push_back({name, "m"});
  }
  Result<CsvReader> csv = OpenTable(path, header);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  Hall hall;
  int origins = 0, rooms = 0;
  while (csv->NextRow()) {
    const Result<HallRow> row = ReadRow(*csv);
    ALIDADE_RETURN_IF_ERROR(row.status());
    ALIDADE_RETURN_IF_ERROR(AddRow(*csv, *row, &hall));
    origins += row->shape == "origin" ? 1 : 0;
    rooms += row->shape == "room" ? 1 : 0;
  }
  if (origins != 1 || rooms != 1) {
    return Status::Input(path + ": found " + std::to_string(origins) + " rows origin and " +
                         std::to_string(rooms) + " rows room, expected one of each");
  }
  if (std::any_of(hall.moving.begin(), hall.moving.end(),
                  [](const MovingBox& moving) { return moving.period_s == 0; })) {
    return Status::Input(path + ": a row moving without a row travel after it");
  }
  return hall;
}

}  // namespace alidade
