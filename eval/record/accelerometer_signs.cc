#include "eval/record/accelerometer_signs.h"

#include <algorithm>

#include "frontend/initialization/initializer.h"

namespace alidade {
namespace {

/// Whether a start is found in the frames from begin_ns to end_ns, stamps of the camera's clock.
bool StartsWithin(const EstimatorConfig& config, const MeasurementLog& log, TimeNs begin_ns, TimeNs end_ns) {
  constexpr double kScaleStd = 0.5;
  constexpr TimeNs kMarginNs = kSecondNs / 10;  // of samples before the first frame, for curvature
  const TimeNs offset_ns = SecondsToNs(log.rig.camera_time_offset_s);
  Initializer initializer(config, log.rig, {kScaleStd, 1, kScaleStd, 2});
  auto sample = std::lower_bound(log.imu.begin(), log.imu.end(), begin_ns + offset_ns - kMarginNs,
                                 [](const ImuSample& s, TimeNs t_ns) { return s.stamp_ns < t_ns; });
  for (const TrackFrame& frame : log.frames) {
    if (frame.stamp_ns < begin_ns || frame.stamp_ns > end_ns) {
      continue;
    }
    // Up to and including the first one at or after the frame.
    for (bool reached = false; !reached && sample != log.imu.end(); ++sample) {
      initializer.AddImu(*sample);
      reached = sample->stamp_ns >= frame.stamp_ns + offset_ns;
    }
    if (initializer.AddFrame(frame).ok()) {
      return true;
    }
  }
  return false;
}

}  // namespace

const std::array<AccelerometerSigns, 8>& SignChoices() {
  static const std::array<AccelerometerSigns, 8> choices = {
      {{{1, 1, 1}, "no axis of the accelerometer"},
       {{-1, -1, -1}, "all axes of the accelerometer"},
       {{1, 1, -1}, "the accelerometer's z axis"},
       {{1, -1, 1}, "the accelerometer's y axis"},
       {{-1, 1, 1}, "the accelerometer's x axis"},
       {{-1, -1, 1}, "the accelerometer's x and y axes"},
       {{-1, 1, -1}, "the accelerometer's x and z axes"},
       {{1, -1, -1}, "the accelerometer's y and z axes"}}};
  return choices;
}

std::optional<SignFinding> SearchSigns(const SignTrials& trials) {
  int reruns = 0;
  for (std::size_t choice = 0; choice < SignChoices().size() && reruns < kMostReruns && !trials.stopped();
       ++choice) {
    if (!trials.starts(choice)) {
      continue;
    }
    if (choice == 0) {
      return std::nullopt;
    }
    if (reruns == 0 && trials.holds(0)) {
      return std::nullopt;  // the failure has another cause
    }
    ++reruns;
    if (const std::optional<double> held_s = trials.holds(choice)) {
      return SignFinding{choice, *held_s};
    }
  }
  return std::nullopt;
}

MeasurementLog WithSigns(MeasurementLog log, const Eigen::Vector3d& signs) {
  for (ImuSample& sample : log.imu) {
    sample.accel = sample.accel.cwiseProduct(signs);
  }
  return log;
}

bool StartsInMotion(const EstimatorConfig& config, const MeasurementLog& log, const std::atomic<bool>* stop) {
  constexpr double kWindows = 1.25;
  constexpr int kEnough = 2;
  constexpr int kMostRefused = 3;
  if (log.frames.empty()) {
    return false;
  }
  EstimatorConfig dynamic = config;
  dynamic.init.method = InitMethod::kDynamic;
  const TimeNs first_ns = log.frames.front().stamp_ns;
  const TimeNs length_ns = SecondsToNs(kWindows * config.init.dynamic_window_s);
  const TimeNs room_ns = std::max<TimeNs>(0, log.frames.back().stamp_ns - first_ns - length_ns);
  int found = 0, refused = 0;
  // From the middle outwards: a recording often begins at rest.
  for (const double share : {0.5, 0.75, 0.25, 1.0, 0.0}) {
    if (stop != nullptr && stop->load()) {
      return false;
    }
    const TimeNs begin_ns = first_ns + static_cast<TimeNs>(share * static_cast<double>(room_ns));
    ++(StartsWithin(dynamic, log, begin_ns, begin_ns + length_ns) ? found : refused);
    if (found == kEnough || refused == kMostRefused) {
      break;
    }
  }
  return found >= kEnough;
}

}  // namespace alidade
