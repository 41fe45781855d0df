#include "eval/trajectory/truth_covariance.h"

#include <filesystem>

#include "eval/files/csv.h"
#include "eval/files/csv_text.h"
#include "eval/files/input_file.h"
#include "eval/trajectory/pose_covariance.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

std::vector<CsvColumn> CovarianceHeader() {
  std::vector<CsvColumn> header = {{"timestamp", "ns"}};
  for (const std::string_view name : PoseCovarianceNames()) {
    header.push_back({name});
  }
  return header;
}

}  // namespace

std::string CovariancePath(const std::string& truth_path) {
  const fs::path path = truth_path;
  return (path.parent_path() / (path.stem().string() + "_covariance.csv")).string();
}

Result<bool> ReadCovarianceBeside(const std::string& truth_path, const std::vector<TimeNs>& stamps,
                                  const std::function<void(size_t row, const Matrix6d& covariance)>& take) {
  const std::string path = CovariancePath(truth_path);
  if (!MayExist(path)) {
    return false;
  }
  Result<CsvReader> csv = CsvReader::Open(path);
  ALIDADE_RETURN_IF_ERROR(csv.status());
  const std::vector<CsvColumn> header = CovarianceHeader();
  csv->NextRow();
  ALIDADE_RETURN_IF_ERROR(csv->ExpectHeader(header));
  size_t row = 0;
  while (csv->NextRow()) {
    ALIDADE_RETURN_IF_ERROR(csv->ExpectColumns(header.size()));
    std::int64_t stamp_ns = 0;
    ALIDADE_RETURN_IF_ERROR(csv->ReadInt64(0, "timestamp", &stamp_ns));
    if (row == stamps.size() || stamp_ns != stamps[row]) {
      return csv->Fault(0, "timestamp",
                        row == stamps.size() ? "no row: " + truth_path + " ends before"
                                             : "the stamp " + std::to_string(stamps[row]) +
                                                   " of the same row of " + truth_path);
    }
    Matrix6d covariance = Matrix6d::Zero();
    ALIDADE_RETURN_IF_ERROR(ReadPoseCovariance(*csv, 1, &covariance));
    take(row++, covariance);
  }
  if (row != stamps.size()) {
    return Status::Input(path + ": holds " + std::to_string(row) + " rows, expected one a pose of " +
                         truth_path + ": " + std::to_string(stamps.size()));
  }
  return true;
}

Status ReadCovarianceBeside(const std::string& truth_path, Trajectory* truth) {
  std::vector<TimeNs> stamps;
  for (const TrajectoryPoint& point : truth->points) {
    stamps.push_back(point.stamp_ns);
  }
  const Result<bool> read = ReadCovarianceBeside(
      truth_path, stamps,
      [truth](size_t row, const Matrix6d& covariance) { truth->points[row].covariance = covariance; });
  ALIDADE_RETURN_IF_ERROR(read.status());
  truth->has_covariance = *read;
  return Status::Ok();
}

std::string CovarianceCsv(const Trajectory& truth) {
  std::string text = "#timestamp [ns]";
  for (const std::string_view name : PoseCovarianceNames()) {
    text.append(",").append(name);
  }
  text += "\n";
  text.reserve(truth.points.size() * 460);
  for (const TrajectoryPoint& point : truth.points) {
    text += std::to_string(point.stamp_ns);
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column) {
        text += "," + CsvNumber(point.covariance(row, column));
      }
    }
    text += "\n";
  }
  return text;
}

}  // namespace alidade
