#pragma once

#include <string>

#include "core/status.h"

namespace alidade {

/// A sequence whose sheets were missing.
struct ProvisionalSequence {
  std::string path;        ///< where to read it: the given folder where nothing is missing
  bool camera = false;     ///< cam0/sensor.yaml was missing: the camera is a guess
  bool imu_noise = false;  ///< imu0/sensor.yaml was missing: noise of a consumer IMU is assumed
};

/// Where imu0/sensor.yaml or cam0/sensor.yaml of the sequence `path` is missing, makes `staging` a sequence
/// of links to its files with provisional sheets: focal length 0.8 of the image's width, principal point in
/// the middle, radial-tangential lens without distortion, camera axes as the body's. The resolution is that
/// of the first image. What an earlier process left in `staging` is removed. follow_links: of the image
/// (ImageFolder).
///
/// Errors (kInput): no image to take the resolution from; kOutput: the links cannot be made.
Result<ProvisionalSequence> CompleteSheets(const std::string& path, const std::string& staging,
                                           bool follow_links = false);

}  // namespace alidade
