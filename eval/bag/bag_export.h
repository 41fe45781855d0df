#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "eval/bag/bag_topics.h"
#include "eval/dataset/dataset.h"
#include "eval/rosbag/rosbag_chunk.h"

namespace alidade {

struct BagExportOptions {
  BagTopics topics;
  BagCompression compression = BagCompression::kNone;
  const std::atomic<bool>* stop = nullptr;
  std::function<void(std::size_t done, std::size_t messages)> progress;
};

/// Writes a sequence as a ROS 1 bag: IMU, images as mono8, GNSS as gnss_comm says it (with the pulse of every
/// second and its trigger, so that GVINS finds the time offset), and what has no standard message, tracks,
/// truth and the sensor sheets, as alidade's own messages, so that reading it back loses nothing but what
/// bags.md says. Messages come in the order of their stamps; those without one at the beginning. Errors: an
/// image that does not decode; kDiverged: stopped.
Status WriteBag(const Dataset& dataset, const BagExportOptions& options, const std::string& path);

}  // namespace alidade
