#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "core/error_convention.h"
#include "eval/dataset/dataset.h"
#include "eval/study/start_study.h"
#include "frontend/initialization/initializer.h"

namespace alidade::test {

/// What came of starting an initializer somewhere in a sequence.
struct StartOutcome {
  bool ok = false;
  std::string message;  // the last refusal, or the report
  std::string method;
  double waited_s = 0;     // from the first frame
  double scale_error = 0;  // |estimated window size / true size - 1|
  double scale_std = 0;
  double tilt_error_rad = 0;
  double velocity_error_mps = 0;
  double nees = 0;        // 11 degrees of freedom: tilt, velocity, biases (5 without bias truth)
  double slowest_ms = 0;  // of one AddFrame
  double total_ms = 0;
  NavEstimate estimate;
};

inline const TrajectoryPoint* TruthAt(const Trajectory& truth, TimeNs stamp_ns) {
  const auto after =
      std::lower_bound(truth.points.begin(), truth.points.end(), stamp_ns,
                       [](const TrajectoryPoint& point, TimeNs stamp) { return point.stamp_ns < stamp; });
  const TrajectoryPoint* best = nullptr;
  for (auto point = after == truth.points.begin() ? after : after - 1;
       point != truth.points.end() && point <= after; ++point) {
    if (best == nullptr || std::abs(point->stamp_ns - stamp_ns) < std::abs(best->stamp_ns - stamp_ns)) {
      best = &*point;
    }
  }
  return best != nullptr && std::abs(best->stamp_ns - stamp_ns) < 6'000'000 ? best : nullptr;
}

inline void Compare(const Initializer& initializer, const Dataset& dataset, StartOutcome* outcome) {
  const TrajectoryPoint* truth = TruthAt(*dataset.truth, outcome->estimate.stamp_ns);
  if (truth == nullptr) {
    return;
  }
  const Vector15d error = GaugeFreeError(outcome->estimate, *truth);
  outcome->tilt_error_rad = error.head<3>().norm();
  outcome->velocity_error_mps = error.segment<3>(6).norm();
  const Eigen::Index size = dataset.truth->has_bias ? 15 : 9;
  outcome->nees = error.head(size).dot(
      outcome->estimate.covariance.topLeftCorner(size, size).ldlt().solve(error.head(size)));
  const InitializerWindow& window = initializer.window();
  outcome->scale_std = window.relative_scale_std;
  double estimated = 0;
  double real = 0;
  for (size_t i = 0; i < window.states.size(); ++i) {
    const TrajectoryPoint* point = TruthAt(*dataset.truth, window.stamps_ns[i]);
    if (point != nullptr) {
      estimated += (window.states[i].p_WB - window.states.back().p_WB).squaredNorm();
      real += (point->nav.p_WB - truth->nav.p_WB).squaredNorm();
    }
  }
  outcome->scale_error = window.states.empty() ? 0 : std::abs(std::sqrt(estimated / real) - 1);
}

/// Feeds the frames from `start_ns` on to a new initializer until it succeeds or `limit_s` have passed.
inline StartOutcome StartAt(const EstimatorConfig& config, const Dataset& dataset, TimeNs start_ns,
                            double limit_s, const ScaleDemand& demand = {}) {
  Initializer initializer(config, dataset.rig, demand);
  StartOutcome outcome;
  auto sample = std::lower_bound(dataset.imu.begin(), dataset.imu.end(), start_ns - 20'000'000,
                                 [](const ImuSample& s, TimeNs stamp) { return s.stamp_ns < stamp; });
  TimeNs first_ns = 0;
  for (const TrackFrame& frame : dataset.frames) {
    if (frame.stamp_ns < start_ns) {
      continue;
    }
    first_ns = first_ns == 0 ? frame.stamp_ns : first_ns;
    outcome.waited_s = SecondsBetween(first_ns, frame.stamp_ns);
    if (outcome.waited_s > limit_s) {
      break;
    }
    for (; sample != dataset.imu.end(); ++sample) {
      initializer.AddImu(*sample);
      if (sample->stamp_ns >= frame.stamp_ns) {
        ++sample;
        break;
      }
    }
    const auto begin = std::chrono::steady_clock::now();
    const Result<NavEstimate> found = initializer.AddFrame(frame);
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    outcome.slowest_ms = std::max(outcome.slowest_ms, ms);
    outcome.total_ms += ms;
    outcome.ok = found.ok();
    outcome.message = found.ok() ? initializer.report() : found.message();
    if (found.ok()) {
      outcome.method = initializer.method();
      outcome.estimate = *found;
      if (dataset.truth.has_value()) {
        Compare(initializer, dataset, &outcome);
      }
      break;
    }
  }
  return outcome;
}

}  // namespace alidade::test
