#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/bag/bag_topics.h"
#include "eval/dataset/dataset.h"
#include "eval/dataset/sensor_yaml.h"
#include "eval/rosbag/rosbag_reader.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

/// An image of a bag: pixels, or the bytes of a PNG or JPEG file as the bag has them.
struct BagImage {
  TimeNs stamp_ns = 0;
  GreyImage grey;              ///< no pixels when `file` is set
  std::string_view file;       ///< valid during the call that receives it
  const char* extension = "";  ///< of `file`: png or jpg
};

struct BagImportOptions {
  BagTopics topics;
  /// Calibration instead of the sheets in the bag.
  std::optional<ImuSensor> imu;
  bool imu_is_per_sample = false;  ///< its noise becomes densities at the rate of the bag's samples
  std::optional<CameraSensor> camera;
  /// Receives each image of the camera. Without it the dataset's entries hold the positions of the images in
  /// the bag.
  std::function<Status(const BagImage&)> take_image;
  const std::atomic<bool>* stop = nullptr;
  std::function<void(std::int64_t done, std::int64_t messages)> progress;
};

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
/// (kInput): no IMU, no calibration, a missing topic, an ambiguous topic; kDiverged: stopped.
Result<BagImport> ReadBag(const std::string& path, const BagImportOptions& options);

/// Whether a path names a bag: a file, by its extension.
[[nodiscard]] bool IsBag(const std::string& path);

}  // namespace alidade
