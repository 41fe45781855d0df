#pragma once

#include <string>
#include <vector>

#include "eval/bag/bag_import_options.h"
#include "eval/dataset/dataset.h"
#include "eval/rosbag/rosbag_reader.h"

namespace alidade {

/// A sequence from a bag.
struct BagImport {
  Dataset dataset;  ///< without image entries where `take_image` took them
  BagScan scan;
  std::vector<std::string> remarks;  ///< assumptions, skipped messages and missing items, as text
};

/// Reads a ROS 1 bag: IMU, tracks or images, GNSS of gnss_comm, truth. A bag written by alidade is read back
/// equal. In other bags the truth is receiver_pvt with a fixed carrier solution (positions of the antenna in
/// ENU at the first of them, no attitude); the GNSS time offset is the median over the triggers relative to
/// the last announced pulse. Stamps out of order are sorted, duplicates skipped, with a remark. Errors
/// (kInput): no IMU, no calibration, a missing topic, an ambiguous topic; kUsage: those of MakeBagTopics;
/// kDiverged: stopped.
Result<BagImport> ReadBag(const std::string& path, const BagImportOptions& options);

}  // namespace alidade
