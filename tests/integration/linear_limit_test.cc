#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "filter/filter.h"
#include "smoother/sliding/smoother.h"
#include "tests/integration/one_window.h"
#include "tests/integration/term_solution.h"
#include "tests/support/estimate_difference.h"
#include "tests/support/fix_scenario.h"
#include "tests/support/jacobian_checker.h"

// One window without marginalisation is one least-squares problem. The filter linearises it once and the
// smoother until it converges, so that they differ by the curvature over the errors alone: where the errors
// vanish against the assumed deviations, both must end with the same mean and the same covariance.

namespace alidade {
namespace {

using test::kFrames;
using test::kGravity;
using test::kTracks;
using test::MakeWindow;
using test::MeanDifference;
using test::OneWindow;
using test::RelativeDifference;
using test::TermSolution;

/// Room for the whole window, no kernel; the gate passes all that the model explains.
EstimatorConfig MakeConfig(ErrorConvention convention) {
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
const std::array<FilterCase, 4>& FilterCases() {
  static const std::array<FilterCase, 4> cases = {
      {{"pose-only", FilterLandmark::kPoseOnlyMulti},
       {"eliminated landmarks", FilterLandmark::kMsckf},
       {"SLAM features", FilterLandmark::kMsckf, kTracks},
       {"track memory", FilterLandmark::kPoseOnlyMulti, 0, TrackMemoryPolicy::kCarry}}};
  return cases;
}

std::unique_ptr<Estimator> MakeFilter(const FilterCase& of, EstimatorConfig config,
                                      const RigCalibration& rig) {
  config.filter.landmark = of.landmark;
  config.filter.slam_features = of.slam_features;
  config.filter.slam_min_track = 4;
  config.filter.slam_max_depth_deviation = 1;
  config.filter.track_memory = of.memory;
  config.filter.memory_depth_deviation = 1;
  return alidade::MakeFilter(config, rig);
}

std::unique_ptr<Estimator> MakeSmoother(SmootherLandmark landmark, EstimatorConfig config,
                                        const RigCalibration& rig) {
  config.smoother.landmark = landmark;
  return alidade::MakeSmoother(config, rig);
}

NavEstimate Estimate(const OneWindow& window, Estimator* estimator) {
  EXPECT_TRUE(estimator->Initialize(window.start).ok());
  if (!window.fixes.empty()) {
    EXPECT_TRUE(estimator->Align(test::IdentityAlignment(window.start.stamp_ns)).ok());
  }
  size_t next = 0;
  size_t next_fix = 0;
  for (const TrackFrame& frame : window.frames) {
    while (next < window.samples.size() && window.samples[next].stamp_ns <= frame.stamp_ns) {
      EXPECT_TRUE(estimator->AddImu(window.samples[next++]).ok());
    }
    const Status status = estimator->AddFrame(frame);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(estimator->last_statistics().features_gated, 0);
    EXPECT_EQ(estimator->last_statistics().features_degenerate, 0);
    for (; next_fix < window.fixes.size() && window.fixes[next_fix].stamp_ns == frame.stamp_ns; ++next_fix) {
      const Status taken = estimator->AddMeasurement(window.fixes[next_fix]);
      EXPECT_TRUE(taken.ok()) << taken.message();
    }
  }
  EXPECT_EQ(next_fix, window.fixes.size());
  return estimator->Latest();
}

constexpr SmootherLandmark kSmootherLandmarks[] = {SmootherLandmark::kPoseOnly,
                                                   SmootherLandmark::kInverseDepth};

class LinearLimitTest : public testing::TestWithParam<ErrorConvention> {};

std::string Name(const FilterCase& filter, SmootherLandmark landmark) {
  return filter.name + (landmark == SmootherLandmark::kPoseOnly ? " to pose-only" : " to inverse depth");
}

/// Every filter ends at `solved`, the means to a millionth of `correction`.
void ExpectFiltersAgree(const OneWindow& window, const EstimatorConfig& config, SmootherLandmark landmark,
                        const NavEstimate& solved, double correction) {
  for (const FilterCase& filter : FilterCases()) {
    SCOPED_TRACE(Name(filter, landmark));
    const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
    EXPECT_LT(MeanDifference(filtered, solved), 1e-6 * correction);
    EXPECT_LT(RelativeDifference(filtered.covariance, solved.covariance), 1e-6);
  }
}

// GIVEN equal starts, IMU samples and tracks whose errors are small WHEN the filter has read one window and
// the smoother's terms of it are solved, THEN the newest states agree to a millionth: the means relative to
// the correction by the measurements, the covariances relative to themselves; whichever way either of them
// treats landmarks.
TEST_P(LinearLimitTest, FilterAgreesWithTheSolutionOfTheSmoothersTerms) {
  const OneWindow window = MakeWindow(1e-6);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate solved = TermSolution(window, config, landmark).Newest();
    const double correction = MeanDifference(window.carried, solved);
    EXPECT_GT(correction, 1e-6) << "vision has something to correct";
    EXPECT_GT(RelativeDifference(window.carried.covariance, solved.covariance), 1) << "and is informative";
    ExpectFiltersAgree(window, config, landmark, solved, correction);
  }
}

// GIVEN position fixes at some of the frames besides, THEN the same holds, and the smoother itself, its
// solver going on to the minimum, ends there too.
TEST_P(LinearLimitTest, FilterSmootherAndTermsAgreeOnPositionFixes) {
  const OneWindow window = MakeWindow(1e-6, true);
  ASSERT_EQ(window.fixes.size(), 3u);
  EstimatorConfig config = MakeConfig(GetParam());
  config.smoother.solve_to_rounding = true;
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate solved = TermSolution(window, config, landmark).Newest();
    const NavEstimate without = TermSolution(MakeWindow(1e-6), config, landmark).Newest();
    EXPECT_GT(RelativeDifference(without.covariance, solved.covariance), 0.1) << "the fixes are informative";
    const double correction = MeanDifference(window.carried, solved);
    const NavEstimate smoothed = Estimate(window, MakeSmoother(landmark, config, window.rig).get());
    EXPECT_LT(MeanDifference(smoothed, solved), 1e-6 * correction);
    EXPECT_LT(RelativeDifference(smoothed.covariance, solved.covariance), 1e-6);
    ExpectFiltersAgree(window, config, landmark, solved, correction);
  }
}

// GIVEN a rig that stands still, whose tracks have no parallax and are left out by both, WHEN rest is
// measured, THEN both end with the same mean and covariance.
TEST_P(LinearLimitTest, FilterAgreesWithTheSmootherAtRest) {
  const OneWindow window = test::MakeWindowAtRest(1e-6);
  EstimatorConfig config = MakeConfig(GetParam());
  config.vision.rest_updates = true;
  config.vision.max_relative_depth_deviation = 0.1;
  config.smoother.keyframe_min_tracked = 0;  // no assumed depths
  config.smoother.solve_to_rounding = true;
  const std::unique_ptr<Estimator> smoother = MakeSmoother(SmootherLandmark::kPoseOnly, config, window.rig);
  const std::unique_ptr<Estimator> filter = MakeFilter(FilterCases()[0], config, window.rig);
  const NavEstimate smoothed = Estimate(window, smoother.get());
  const NavEstimate filtered = Estimate(window, filter.get());
  for (const Estimator* estimator : {smoother.get(), filter.get()}) {
    EXPECT_TRUE(estimator->last_statistics().at_rest);
    EXPECT_EQ(estimator->last_statistics().features_used, 0);
  }
  EXPECT_GT(RelativeDifference(window.carried.covariance, smoothed.covariance), 1) << "rest is informative";
  EXPECT_LT(MeanDifference(filtered, smoothed), 1e-6 * MeanDifference(window.carried, smoothed));
  EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-6);
}

// GIVEN the window of IMU and vision, THEN the smoother itself ends with that covariance, and, its solver
// going on to the minimum, with that mean to a millionth of the correction. As shipped, its solver stops
// within a millionth of a deviation and a hundredth of the correction.
TEST_P(LinearLimitTest, FilterAgreesWithTheSmoother) {
  const OneWindow window = MakeWindow(1e-6);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const std::unique_ptr<Estimator> smoother = MakeSmoother(landmark, config, window.rig);
    const NavEstimate smoothed = Estimate(window, smoother.get());
    EXPECT_EQ(smoother->last_statistics().features_used, kTracks);
    EstimatorConfig to_rounding = config;
    to_rounding.smoother.solve_to_rounding = true;
    const NavEstimate minimum = Estimate(window, MakeSmoother(landmark, to_rounding, window.rig).get());
    for (const FilterCase& filter : FilterCases()) {
      SCOPED_TRACE(Name(filter, landmark));
      const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
      EXPECT_LT(MeanDifference(filtered, smoothed), 1e-6);
      EXPECT_LT(MeanDifference(filtered, smoothed), 0.01 * MeanDifference(window.carried, smoothed));
      EXPECT_LT(MeanDifference(filtered, minimum), 1e-6 * MeanDifference(window.carried, smoothed));
      EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-6);
    }
  }
}

// GIVEN data without any error, THEN both linearise at the same point: the covariances agree to rounding.
TEST_P(LinearLimitTest, WithoutErrorsTheCovariancesAreTheSame) {
  const OneWindow window = MakeWindow(0);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate smoothed = Estimate(window, MakeSmoother(landmark, config, window.rig).get());
    for (const FilterCase& filter : FilterCases()) {
      const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
      EXPECT_LT(MeanDifference(filtered, smoothed), 1e-9) << Name(filter, landmark);
      EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-9) << Name(filter, landmark);
    }
  }
}

// GIVEN errors ten times as small, THEN the difference of the covariances is: what is left is the point of
// linearisation, to first order.
TEST_P(LinearLimitTest, TheDifferenceVanishesWithTheErrors) {
  const auto difference = [&](const FilterCase& filter, double scale) {
    const OneWindow window = MakeWindow(scale);
    const EstimatorConfig config = MakeConfig(GetParam());
    const NavEstimate smoothed =
        Estimate(window, MakeSmoother(SmootherLandmark::kPoseOnly, config, window.rig).get());
    const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
    return RelativeDifference(filtered.covariance, smoothed.covariance);
  };
  for (const FilterCase& filter : FilterCases()) {
    EXPECT_NEAR(difference(filter, 1e-3) / difference(filter, 1e-2), 0.1, 0.02) << filter.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, LinearLimitTest, testing::ValuesIn(test::kAllConventions),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade
