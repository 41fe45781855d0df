#include "eval/record/recorder_covariance.h"

#include <utility>

#include "eval/files/output_file.h"

namespace alidade {
namespace {

/// Of velocity, gyroscope bias and accelerometer bias: where they start in the state.
constexpr std::pair<const char*, Eigen::Index> kMotionBlocks[] = {{"v", 6}, {"bg", 9}, {"ba", 12}};

}  // namespace

std::string MotionCovarianceHeader() {
  std::string text = "timestamp_ns";
  for (const auto& [name, first] : kMotionBlocks) {
    for (const char* axes : {"xx", "xy", "xz", "yy", "yz", "zz"}) {
      text += std::string(",") + name + "_" + axes;
    }
  }
  return text + "\n";
}

void AppendMotionCovariance(const RunRecord& record, std::string* text) {
  *text += std::to_string(record.estimate.stamp_ns);
  for (const auto& [name, first] : kMotionBlocks) {
    for (Eigen::Index i = first; i < first + 3; ++i) {
      for (Eigen::Index j = i; j < first + 3; ++j) {
        *text += "," + ShortestDouble(record.estimate.covariance(i, j));
      }
    }
  }
  *text += '\n';
}

Status ReadMotionCovarianceRow(const CsvReader& row, RunRecord* record) {
  size_t column = 1;
  for (const auto& [name, first] : kMotionBlocks) {
    for (Eigen::Index i = first; i < first + 3; ++i) {
      for (Eigen::Index j = i; j < first + 3; ++j) {
        double& value = record->estimate.covariance(i, j);
        ALIDADE_RETURN_IF_ERROR(row.ReadReal(column++, name, &value));
        record->estimate.covariance(j, i) = value;
      }
    }
  }
  return Status::Ok();
}

}  // namespace alidade
