#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "filter/filter.h"
#include "smoother/sliding/smoother.h"
#include "tests/integration/one_window.h"
#include "tests/support/estimate_difference.h"

// What the tests of the linear limit share: one window through each back end.

namespace alidade::test {

/// Room for the whole window, no kernel; the gate passes all that the model explains.
inline EstimatorConfig MakeConfig(ErrorConvention convention) {
  EstimatorConfig config;
  config.imu.gravity_mps2 = kGravity;
  config.vision.robust_kernel = RobustKernel::kNone;
  config.vision.max_relative_depth_deviation = 1;
  config.vision.gate_probability = 1 - 1e-9;
  config.vision.rest_updates = false;
  config.fix.robust_kernel = RobustKernel::kNone;
  config.fix.gate_probability = 1 - 1e-9;
  config.filter.error = convention;
  config.filter.window = kFrames + 2;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.smoother.error = convention;
  config.smoother.window = kFrames + 2;
  config.smoother.frames = FramePolicy::kEveryFrame;
  return config;
}

struct FilterCase {
  std::string name;
  FilterLandmark landmark = FilterLandmark::kMsckf;
  int slam_features = 0;
  TrackMemoryPolicy memory = TrackMemoryPolicy::kNone;
};

/// How the filter uses a view: with its track at the end, or at once by what it keeps of the landmark.
inline const std::array<FilterCase, 4>& FilterCases() {
  static const std::array<FilterCase, 4> cases = {
      {{"pose-only", FilterLandmark::kPoseOnlyMulti},
       {"eliminated landmarks", FilterLandmark::kMsckf},
       {"SLAM features", FilterLandmark::kMsckf, kTracks},
       {"track memory", FilterLandmark::kPoseOnlyMulti, 0, TrackMemoryPolicy::kCarry}}};
  return cases;
}

inline std::unique_ptr<Estimator> MakeFilter(const FilterCase& of, EstimatorConfig config,
                                             const RigCalibration& rig) {
  config.filter.landmark = of.landmark;
  config.filter.slam_features = of.slam_features;
  config.filter.slam_min_track = 4;
  config.filter.slam_max_depth_deviation = 1;
  config.filter.track_memory = of.memory;
  config.filter.memory_depth_deviation = 1;
  return alidade::MakeFilter(config, rig);
}

inline std::unique_ptr<Estimator> MakeSmoother(SmootherLandmark landmark, EstimatorConfig config,
                                               const RigCalibration& rig) {
  config.smoother.landmark = landmark;
  return alidade::MakeSmoother(config, rig);
}

/// What a back end ends with.
struct Ends {
  NavEstimate state;
  std::optional<ClockState> clock;
  std::optional<CalibrationEstimate> calibration;
};

template <typename Message, typename Add>
void Deliver(const std::vector<Message>& messages, TimeNs stamp_ns, const Add& add) {
  for (const Message& message : messages) {
    if (message.stamp_ns == stamp_ns) {
      const Status status = add(message);
      EXPECT_TRUE(status.ok()) << status.message();
    }
  }
}

inline Ends Run(const OneWindow& window, Estimator* estimator) {
  EXPECT_TRUE(estimator->Initialize(window.start).ok());
  if (window.alignment) {
    EXPECT_TRUE(estimator->Align(*window.alignment).ok());
  }
  size_t next = 0;
  for (const TrackFrame& frame : window.frames) {
    while (next < window.samples.size() && window.samples[next].stamp_ns <= frame.stamp_ns) {
      EXPECT_TRUE(estimator->AddImu(window.samples[next++]).ok());
    }
    const Status status = estimator->AddFrame(frame);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(estimator->last_statistics().features_gated, 0);
    EXPECT_EQ(estimator->last_statistics().features_degenerate, 0);
    EXPECT_EQ(estimator->last_statistics().satellites_gated, 0);
    Deliver(window.fixes, frame.stamp_ns,
            [&](const PositionFix& fix) { return estimator->AddMeasurement(fix); });
    Deliver(window.epochs, frame.stamp_ns, [&](const GnssEpoch& epoch) { return estimator->AddGnss(epoch); });
  }
  return {estimator->Latest(), estimator->LatestClock(), estimator->LatestCalibration()};
}

inline NavEstimate Estimate(const OneWindow& window, Estimator* estimator) {
  return Run(window, estimator).state;
}

inline constexpr SmootherLandmark kSmootherLandmarks[] = {SmootherLandmark::kPoseOnly,
                                                          SmootherLandmark::kInverseDepth};

inline std::string Name(const FilterCase& filter, SmootherLandmark landmark) {
  return filter.name + (landmark == SmootherLandmark::kPoseOnly ? " to pose-only" : " to inverse depth");
}

/// Every filter ends at `solved`, the means to a millionth of `correction`.
inline void ExpectFiltersAgree(const OneWindow& window, const EstimatorConfig& config,
                               SmootherLandmark landmark, const NavEstimate& solved, double correction) {
  for (const FilterCase& filter : FilterCases()) {
    SCOPED_TRACE(Name(filter, landmark));
    const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
    EXPECT_LT(MeanDifference(filtered, solved), 1e-6 * correction);
    EXPECT_LT(RelativeDifference(filtered.covariance, solved.covariance), 1e-6);
  }
}

}  // namespace alidade::test
