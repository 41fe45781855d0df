#pragma once

#include <string>
#include <vector>

#include "core/status.h"

namespace alidade {

struct Dataset;

/// Where a sequence comes from: a folder in the extended ASL layout, or a ROS bag and what that lacks.
struct DatasetSource {
  std::string path;
  std::string topics;                    ///< of a bag, as BagTopics::Set takes them
  std::vector<std::string> calibration;  ///< files of other programs, before the sheets in a bag
  std::string camera = "cam0";           ///< which of several in those files
};

/// ReadDataset; `remarks` takes what was guessed or passed over in a bag, for a person. kUsage: topics that
/// are none, or topics or calibration beside a folder, which has its own; kInput: as ReadDataset and
/// ImportCalibration.
Result<Dataset> ReadDataset(const DatasetSource& source, std::vector<std::string>* remarks);

/// SHA-256 (hex) over everything that the sequence is read from.
Result<std::string> DigestOf(const DatasetSource& source);

}  // namespace alidade
