#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "eval/dataset/dataset.h"
#include "eval/rosbag/rosbag_chunk.h"

namespace alidade {

struct BagExportOptions {
  std::string topics;  ///< names, as MakeBagTopics takes them
  BagCompression compression = BagCompression::kNone;
  const std::atomic<bool>* stop = nullptr;
  std::function<void(std::size_t done, std::size_t messages)> progress;
};

/// Writes a sequence as a ROS 1 bag: IMU, images as mono8, GNSS as gnss_comm messages (with the pulse of
/// every second and its trigger, from which GVINS computes the time offset). Tracks, truth and the sensor
/// sheets have no standard message and become messages of type alidade/*. Reading back loses only what
/// docs/bags.md lists. Messages are in the order of their stamps; those without a stamp are first. Errors: an
/// image that does not decode; those of MakeBagTopics; kDiverged: stopped.
Status WriteBag(const Dataset& dataset, const BagExportOptions& options, const std::string& path);

}  // namespace alidade
