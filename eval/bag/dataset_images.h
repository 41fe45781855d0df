#pragma once

#include <optional>

#include "eval/dataset/dataset.h"
#include "eval/rosbag/rosbag_reader.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

/// Reads the images of a sequence, from files or from its bag.
class DatasetImages {
 public:
  /// Fastest in the order of the stamps. kInput: missing, does not decode, or of another encoding than mono,
  /// rgb or bgr.
  Result<GreyImage> Read(const ImageEntry& image);
  /// Read, and kInput when the image has not the camera's resolution.
  Result<GreyImage> ReadFor(const CameraModel& camera, const ImageEntry& image);

 private:
  std::optional<RosbagReader> bag_;
};

}  // namespace alidade
