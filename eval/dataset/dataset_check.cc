#include "eval/dataset/dataset_check.h"

#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/dataset_parts.h"
#include "eval/dataset/log_tables.h"

namespace alidade {

std::vector<DatasetFinding> CheckDataset(const Dataset& dataset) {
  constexpr size_t kLeastSamples = 2;  // of the IMU, the first part, with whose time the others are compared
  Findings findings;
  for (const std::string& remark : dataset.remarks) {
    findings.Warning(remark);
  }
  for (const DatasetPart& part : DatasetParts()) {
    part.check(dataset, &findings);
    if (TablesOf(dataset).imu.size() < kLeastSamples) {
      break;
    }
  }
  return findings.Take();
}

}  // namespace alidade
