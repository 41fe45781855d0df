#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"
#include "eval/dataset/sensor_yaml.h"
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
  std::string topics;  ///< names, as MakeBagTopics takes them
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

}  // namespace alidade
