#pragma once

#include <string>
#include <vector>

#include "core/status.h"
#include "eval/dataset/dataset.h"

namespace alidade {

/// Where a sequence comes from: a folder in the extended ASL layout, or a ROS bag with the calibration that
/// the bag lacks.
struct DatasetSource {
  std::string path;
  std::string topics;                    ///< of a bag, as MakeBagTopics takes them
  std::vector<std::string> calibration;  ///< files of other programs, before the sheets in a bag
  std::string camera = "cam0";           ///< camera to use in those files
  bool follow_links = false;             ///< of a folder, DatasetStorage::follow_links
};

/// ReadDataset of a folder, or ReadBag, with the remarks of either in Dataset::remarks. kUsage: invalid
/// topics, topics or calibration for a folder, which has its own, or follow_links for a bag; kInput: as
/// ReadDataset and ImportCalibration. A bag is read whole before it goes into files.
Result<Dataset> ReadDataset(const DatasetSource& source, const DatasetStorage& storage = {});

/// SHA-256 (hex) over everything that the sequence is read from.
Result<std::string> DigestOf(const DatasetSource& source);

}  // namespace alidade
