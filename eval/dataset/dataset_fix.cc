#include "eval/dataset/dataset_fix.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include "core/dense_solvers.h"
#include "eval/dataset/log_hasher.h"
#include "eval/dataset/sensor_file.h"
#include "eval/dataset/sensor_table.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/dataset/stale_parts.h"
#include "eval/files/input_file.h"
#include "eval/files/output_file.h"
#include "eval/trajectory/nmea_reader.h"
#include "eval/trajectory/position_file_reader.h"
#include "gnss/base/anchor_llh.h"
#include "gnss/base/text_file.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

/// Upper triangle of the covariance by column of data.csv.
struct Entry {
  const char* name;
  int row;
  int column;
};
constexpr std::array<Entry, 6> kEntries = {
    {{"c_xx", 0, 0}, {"c_xy", 0, 1}, {"c_xz", 0, 2}, {"c_yy", 1, 1}, {"c_yz", 1, 2}, {"c_zz", 2, 2}}};

struct FixSheet : FixSensor {
  std::string positions = "data.csv";
  std::optional<CalendarTime> date;
};

Status ReadVector(const SensorFile& file, const char* key, Eigen::Vector3d* value) {
  std::vector<double> numbers;
  ALIDADE_RETURN_IF_ERROR(file.ReadReals(key, 3, &numbers));
  *value = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  return Status::Ok();
}

Status ReadDate(const SensorFile& file, std::optional<CalendarTime>* date) {
  if (!file.Has("date")) {
    return Status::Ok();
  }
  std::string text = file["date"].IsScalar() ? file["date"].Scalar() : std::string();
  std::replace(text.begin(), text.end(), '-', ' ');
  const Result<CalendarTime> parsed = ParseCalendar(text + " 0 0 0");
  if (!parsed.ok()) {
    return file.Fault("date", "YYYY-MM-DD");
  }
  *date = *parsed;
  return Status::Ok();
}

Result<FixSheet> MakeFixSheet(const Result<YAML::Node>& root, const std::string& path) {
  const Result<SensorFile> file = SensorFile::Make(root, path, "position");
  ALIDADE_RETURN_IF_ERROR(file.status());
  FixSheet sheet;
  const bool unknown =
      file->Has("p_BA") && (*file)["p_BA"].IsScalar() && (*file)["p_BA"].Scalar() == "unknown";
  if (!file->Has("p_BA")) {
    return file->Fault("p_BA", "the measured point in the body frame [m], or unknown");
  }
  if (!unknown) {
    ALIDADE_RETURN_IF_ERROR(ReadVector(*file, "p_BA", &sheet.p_BA));
  }
  if (file->Has("time_offset_s")) {
    ALIDADE_RETURN_IF_ERROR(file->ReadReal("time_offset_s", -kMaxClockOffsetS, &sheet.time_offset_s));
    if (sheet.time_offset_s > kMaxClockOffsetS) {
      return file->Fault("time_offset_s", kClockOffsetExpected);
    }
  }
  if (file->Has("anchor_llh_deg")) {
    Eigen::Vector3d llh;
    ALIDADE_RETURN_IF_ERROR(ReadVector(*file, "anchor_llh_deg", &llh));
    constexpr double kHighestM = 1e5;
    if (std::abs(llh[0]) > 90 || std::abs(llh[1]) > 360 || std::abs(llh[2]) > kHighestM) {
      return file->Fault("anchor_llh_deg", "latitude [deg], longitude [deg] and height [m]");
    }
    sheet.anchor_llh_deg = llh;
  }
  if (file->Has("positions")) {
    sheet.positions = (*file)["positions"].IsScalar() ? (*file)["positions"].Scalar() : std::string();
    if (sheet.positions.empty() || !StaysInFolder(sheet.positions)) {
      return file->Fault("positions", "the name of a file in the folder of this sheet");
    }
  }
  ALIDADE_RETURN_IF_ERROR(ReadDate(*file, &sheet.date));
  return sheet;
}

Result<std::vector<PositionFix>> ReadFixCsv(const std::string& path, int sensor) {
  std::vector<CsvColumn> header = {{"timestamp", "ns"}, {"p_x", "m"}, {"p_y", "m"}, {"p_z", "m"}};
  for (const Entry& entry : kEntries) {
    header.push_back({entry.name, entry.column == 2 && entry.row == 2 ? "m^2" : ""});
  }
  Result<CsvReader> csv = OpenTable(path, header);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  std::vector<PositionFix> fixes;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(header.size()));
    PositionFix fix;
    fix.sensor = sensor;
    ALIDADE_RETURN_IF_ERROR(
        csv->ReadStamp(fixes.empty(), fixes.empty() ? 0 : fixes.back().stamp_ns, &fix.stamp_ns));
    for (int i = 0; i < 3; ++i) {
      const std::size_t column = static_cast<std::size_t>(i) + 1;
      ALIDADE_RETURN_IF_ERROR(csv->ReadReal(column, header[column].name, &fix.p_A[i]));
    }
    for (std::size_t i = 0; i < kEntries.size(); ++i) {
      double value = 0;
      ALIDADE_RETURN_IF_ERROR(csv->ReadReal(4 + i, kEntries[i].name, &value));
      fix.covariance(kEntries[i].row, kEntries[i].column) = value;
      fix.covariance(kEntries[i].column, kEntries[i].row) = value;
    }
    if (!IsPositiveDefinite(fix.covariance)) {
      return csv->Fault(4, "c_xx", "the upper triangle of a positive definite covariance");
    }
    fixes.push_back(fix);
  }
  return fixes;
}

/// Positions on the Earth in ENU at the sheet's anchor, or at the first of them.
std::vector<PositionFix> InEnu(const std::vector<FilePosition>& positions, int sensor, FixSensor* sheet) {
  if (!sheet->anchor_llh_deg) {
    sheet->anchor_llh_deg = LlhDegOf(positions.front().position_E);
  }
  const EnuFrame enu = EnuFrameAtLlh(*sheet->anchor_llh_deg);
  std::vector<PositionFix> fixes;
  for (const FilePosition& position : positions) {
    const Eigen::Matrix3d covariance = enu.R_EN.transpose() * position.covariance_E * enu.R_EN;
    fixes.push_back({position.stamp_ns, sensor, enu.FromEcef(position.position_E),
                     0.5 * (covariance + covariance.transpose())});
  }
  return fixes;
}

Result<std::vector<PositionFix>> ReadPositions(const fs::path& path, const std::string& sheet_path,
                                               int sensor, FixSheet* sheet) {
  const std::string extension = path.extension().string();
  if (extension == ".csv") {
    return ReadFixCsv(path.string(), sensor);
  }
  const bool is_nmea = extension == ".nmea" || extension == ".txt" || extension == ".log";
  if (extension != ".pos" && !is_nmea) {
    return Status::Input(sheet_path + ": positions: found '" + sheet->positions +
                         "', expected a name that ends in .csv, .pos, .nmea, .txt or .log");
  }
  const Result<std::vector<FilePosition>> positions =
      is_nmea ? ReadNmeaFile(path.string(), sheet->date) : ReadPositionRows(path.string());
  ALIDADE_RETURN_IF_ERROR(positions.status());
  return InEnu(*positions, sensor, sheet);
}

}  // namespace

std::string FixSensorYaml(const FixSensor& sensor) {
  std::string text =
      "sensor_type: position\np_BA: " + VectorYaml(sensor.p_BA) +
      "  # measured point in the body frame [m]\ntime_offset_s: " + ShortestDouble(sensor.time_offset_s) +
      "  # t_imu = t_fix + offset\n";
  if (sensor.anchor_llh_deg) {
    text += "anchor_llh_deg: " + VectorYaml(*sensor.anchor_llh_deg) +
            "  # origin of the ENU frame: latitude [deg], longitude [deg], height [m]\n";
  }
  return text;
}

Result<FixSensor> ParseFixSheet(const std::string& text, const std::string& where) {
  const Result<FixSheet> sheet = MakeFixSheet(ParseYaml(text, where, StatusCode::kInput), where);
  ALIDADE_RETURN_IF_ERROR(sheet.status());
  return FixSensor(*sheet);
}

void SortFixes(const std::vector<FixSensor>& sensors, std::vector<PositionFix>* fixes) {
  const auto imu_stamp = [&](const PositionFix& fix) {
    return fix.stamp_ns + SecondsToNs(sensors[static_cast<std::size_t>(fix.sensor)].time_offset_s);
  };
  std::stable_sort(fixes->begin(), fixes->end(),
                   [&](const PositionFix& a, const PositionFix& b) { return imu_stamp(a) < imu_stamp(b); });
}

Status ReadFixFolders(const std::string& mav, const DatasetStorage& /*storage*/, Dataset* dataset) {
  for (int sensor = 0;; ++sensor) {
    const fs::path folder = fs::path(mav) / ("fix" + std::to_string(sensor));
    if (!MayBeFolder(folder.string())) {
      break;
    }
    const std::string sheet_path = (folder / "sensor.yaml").string();
    Result<FixSheet> sheet = MakeFixSheet(ParseYamlFile(sheet_path, StatusCode::kInput), sheet_path);
    ALIDADE_RETURN_IF_ERROR(sheet.status());
    const Result<std::vector<PositionFix>> fixes =
        ReadPositions(folder / sheet->positions, sheet_path, sensor, &*sheet);
    ALIDADE_RETURN_IF_ERROR(fixes.status());
    for (const PositionFix& fix : *fixes) {
      ALIDADE_RETURN_IF_ERROR(CheckStampWithOffset(sheet_path, fix.stamp_ns, sheet->time_offset_s));
    }
    dataset->rig.fixes.push_back(*sheet);
    dataset->fixes.insert(dataset->fixes.end(), fixes->begin(), fixes->end());
  }
  SortFixes(dataset->rig.fixes, &dataset->fixes);
  return Status::Ok();
}

Status WriteFixFolders(const Dataset& dataset, const std::string& mav) {
  if (!IsItsOwnFolder(dataset, mav)) {
    for (const std::string& folder : NumberedFolders(mav, "fix", dataset.rig.fixes.size())) {
      ALIDADE_RETURN_IF_ERROR(RemoveStaleFolder(folder));
    }
  }
  for (std::size_t sensor = 0; sensor < dataset.rig.fixes.size(); ++sensor) {
    const fs::path folder = fs::path(mav) / ("fix" + std::to_string(sensor));
    std::string text = "#timestamp [ns],p_x [m],p_y [m],p_z [m],c_xx,c_xy,c_xz,c_yy,c_yz,c_zz [m^2]\n";
    for (const PositionFix& fix : dataset.fixes) {
      if (static_cast<std::size_t>(fix.sensor) != sensor) {
        continue;
      }
      text += std::to_string(fix.stamp_ns);
      for (int i = 0; i < 3; ++i) {
        text += "," + ShortestDouble(fix.p_A[i]);
      }
      for (const Entry& entry : kEntries) {
        text += "," + ShortestDouble(fix.covariance(entry.row, entry.column));
      }
      text += "\n";
    }
    ALIDADE_RETURN_IF_ERROR(
        WriteFileAtomically((folder / "sensor.yaml").string(), FixSensorYaml(dataset.rig.fixes[sensor])));
    ALIDADE_RETURN_IF_ERROR(WriteFileAtomically((folder / "data.csv").string(), text));
  }
  return Status::Ok();
}

Status DigestFixes(const MeasurementLog& log, const LogTables& /*tables*/, LogHasher* hasher) {
  if (log.fixes.empty()) {
    return Status::Ok();
  }
  for (const FixSensor& sensor : log.rig.fixes) {
    hasher->Add(sensor.p_BA);
    hasher->Add(sensor.time_offset_s);
    hasher->Add(std::int64_t{sensor.anchor_llh_deg.has_value()});
    hasher->Add(sensor.anchor_llh_deg.value_or(Eigen::Vector3d::Zero()));
  }
  for (const PositionFix& fix : log.fixes) {
    hasher->Add(std::int64_t{fix.stamp_ns});
    hasher->Add(std::int64_t{fix.sensor});
    hasher->Add(fix.p_A);
    hasher->Add(fix.covariance);
  }
  return Status::Ok();
}

}  // namespace alidade
