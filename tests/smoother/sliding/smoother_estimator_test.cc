#include "smoother/sliding/smoother_estimator.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/smoother/sliding/smoother_fixture.h"
#include "tests/support/estimate_difference.h"

namespace alidade {
namespace {

using test::kLandmarks;
using test::MakeConfig;
using test::MakeSequence;
using test::RunSmoother;
using test::WithSlamFeatures;

TEST(SmootherEstimatorTest, ExactDataGivesTheTruthForBothLandmarks) {
  const Dataset dataset = MakeSequence({.duration_s = 8, .exact = true});
  for (const SmootherLandmark landmark : kLandmarks) {
    const test::ScenarioResult run = RunSmoother(dataset, MakeConfig(landmark), false);
    // The first frames lean on an assumed depth; once there is parallax nothing of it may be left.
    EXPECT_LT(run.max_position_m, 1e-3);
    const NavState& truth = test::TruthAt(dataset, run.last.stamp_ns).nav;
    EXPECT_LT((run.last.nav.p_WB - truth.p_WB).norm(), 1e-4);
    EXPECT_GT(run.frames, 70);
  }
}

TEST(SmootherEstimatorTest, BothLandmarksAgreeOnExactData) {
  const Dataset dataset = MakeSequence({.duration_s = 8, .exact = true});
  EstimatorConfig config = MakeConfig(SmootherLandmark::kInverseDepth);
  config.smoother.max_iterations = 50;
  const test::ScenarioResult explicit_depth = RunSmoother(dataset, config, false);
  config.smoother.landmark = SmootherLandmark::kPoseOnly;
  const test::ScenarioResult pose_only = RunSmoother(dataset, config, false);
  EXPECT_LT((explicit_depth.last.nav.p_WB - pose_only.last.nav.p_WB).norm(), 1e-6);
}

EstimatorConfig WithFirstEstimates(bool first_estimates) {
  EstimatorConfig config = MakeConfig(SmootherLandmark::kPoseOnly, ErrorConvention::kSo3xRn);
  config.smoother.frames = FramePolicy::kEveryFrame;
  config.smoother.first_estimates = first_estimates;
  return config;
}

/// Of the heading, as the last frame claims it.
double YawDeviation(const NavEstimate& estimate) {
  const Eigen::Vector3d up_B = estimate.nav.R_WB.transpose() * Eigen::Vector3d::UnitZ();
  return std::sqrt(up_B.dot(estimate.covariance.topLeftCorner<3, 3>() * up_B));
}

TEST(SmootherEstimatorTest, FirstEstimatesLeaveExactDataExact) {
  const Dataset dataset = MakeSequence({.duration_s = 8, .exact = true});
  const test::ScenarioResult run = RunSmoother(dataset, WithFirstEstimates(true), false);
  EXPECT_LT(run.max_position_m, 1e-3);
  const NavState& truth = test::TruthAt(dataset, run.last.stamp_ns).nav;
  EXPECT_LT((run.last.nav.p_WB - truth.p_WB).norm(), 1e-4);
}

// Nothing measures the heading: it is never better known than at the start, and as well as by the error whose
// unobservable directions depend on no state.
TEST(SmootherEstimatorTest, FirstEstimatesLearnNoHeading) {
  const Dataset dataset = MakeSequence({.duration_s = 10});
  EstimatorConfig invariant = WithFirstEstimates(false);
  invariant.smoother.error = ErrorConvention::kRightInvariant;
  const double claimed = YawDeviation(RunSmoother(dataset, WithFirstEstimates(true), true).last);
  EXPECT_GT(claimed, YawDeviation(test::DrawInitialState(dataset, 1)));
  EXPECT_NEAR(claimed / YawDeviation(RunSmoother(dataset, invariant, true).last), 1, 0.005);
}

TEST(SmootherEstimatorTest, BothLandmarksFindTheSameMinimumInNoise) {
  const Dataset dataset = MakeSequence({.duration_s = 6});
  EstimatorConfig config = MakeConfig(SmootherLandmark::kInverseDepth);
  config.smoother.max_iterations = 30;
  const test::ScenarioResult explicit_depth = RunSmoother(dataset, config, true);
  config.smoother.landmark = SmootherLandmark::kPoseOnly;
  const test::ScenarioResult pose_only = RunSmoother(dataset, config, true);
  ASSERT_EQ(explicit_depth.frames, pose_only.frames);
  const NavEstimate& a = explicit_depth.last;
  const NavEstimate& b = pose_only.last;
  EXPECT_LT((a.nav.p_WB - b.nav.p_WB).norm(), 2e-3);  // a tenth of the standard deviation
  EXPECT_LT(so3::Log(a.nav.R_WB.transpose() * b.nav.R_WB).norm(), 2e-4);
  EXPECT_LT((a.covariance - b.covariance).norm(), 0.05 * a.covariance.norm());
}

// GIVEN 15 m/s and a world that begins a kilometre away THEN the estimate is the same: no direction of the
// window, however weak beside the others, is left behind by the solver.
TEST(SmootherEstimatorTest, TheEstimateDoesNotDependOnWhereTheWorldBegins) {
  SimulatorConfig simulator;
  simulator.duration_s = 6;
  simulator.length_m = 200;
  simulator.width_m = 100;
  simulator.path_m = 90;
  simulator.landmark_min_distance_m = 4;
  simulator.landmark_max_distance_m = 40;
  simulator.max_range_m = 60;
  const Dataset dataset = test::SimulateOrDie(simulator, 5);
  const auto run = [&](const Eigen::Vector3d& shift) {
    SmootherEstimator estimator(WithSlamFeatures(60), dataset.rig);
    NavEstimate initial = test::DrawInitialState(dataset, 5);
    initial.nav.p_WB += shift;
    const test::ScenarioResult result = test::RunScenario(dataset, initial, &estimator);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    EXPECT_GT(result.frames, 50);
    return result.last;
  };
  const Eigen::Vector3d shift(900, -600, 20);
  const NavEstimate here = run(Eigen::Vector3d::Zero());
  const NavEstimate there = run(shift);
  const double position = std::sqrt(here.covariance.block<3, 3>(3, 3).trace());
  const double velocity = std::sqrt(here.covariance.block<3, 3>(6, 6).trace());
  const double orientation = std::sqrt(here.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT((there.nav.p_WB - shift - here.nav.p_WB).norm(), 0.1 * position);
  EXPECT_LT((there.nav.v_WB - here.nav.v_WB).norm(), 0.1 * velocity);
  EXPECT_LT(so3::Log(here.nav.R_WB.transpose() * there.nav.R_WB).norm(), 0.1 * orientation);
  EXPECT_LT((there.covariance - here.covariance).norm(), 0.02 * here.covariance.norm());
}

TEST(SmootherEstimatorTest, EqualInputGivesEqualBits) {
  const Dataset dataset = MakeSequence({.duration_s = 4});
  for (const SmootherLandmark landmark : kLandmarks) {
    const test::ScenarioResult first = RunSmoother(dataset, MakeConfig(landmark), true);
    const test::ScenarioResult second = RunSmoother(dataset, MakeConfig(landmark), true);
    EXPECT_TRUE(test::EqualBits(first.last, second.last));
    EXPECT_EQ(first.rmse_position_m, second.rmse_position_m);
  }
}

TEST(SmootherEstimatorTest, NoisyRunsAreConsistent) {
  double nees = 0;
  constexpr int kRuns = 6;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Dataset dataset = MakeSequence({.duration_s = 10, .seed = seed});
    const SmootherLandmark landmark = kLandmarks[seed % 2];
    const test::ScenarioResult run = RunSmoother(dataset, MakeConfig(landmark), true, seed);
    EXPECT_LT(run.rmse_position_m, 0.15);
    nees += run.nees_pose / kRuns;
  }
  EXPECT_GT(nees, 2.5);
  EXPECT_LT(nees, 10.5);  // errors within a run are correlated: 6 runs scatter widely about 6
}

TEST(SmootherEstimatorTest, EveryConventionAndFramePolicyRuns) {
  const Dataset dataset = MakeSequence({.duration_s = 6});
  for (const ErrorConvention error :
       {ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant, ErrorConvention::kSo3xRn}) {
    EstimatorConfig config = MakeConfig(SmootherLandmark::kPoseOnly, error);
    config.smoother.frames = FramePolicy::kEveryFrame;
    EXPECT_LT(RunSmoother(dataset, config, true).rmse_position_m, 0.15) << ToString(error);
    config.smoother.frames = FramePolicy::kKeyframes;
    config.smoother.keyframe_parallax_px = 40;
    EXPECT_LT(RunSmoother(dataset, config, true).rmse_position_m, 0.15) << ToString(error);
  }
}

// GIVEN a rig at rest with an unknown accelerometer bias, WHEN no track has parallax yet, THEN vision still
// holds it in place.
TEST(SmootherEstimatorTest, DoesNotDriftAtRestBeforeAnyTrackHasParallax) {
  SimulatorConfig simulator;
  simulator.duration_s = 5;
  simulator.path_m = 2;
  simulator.rest_s = 4;
  simulator.rest_ramp_s = 0.5;
  const Dataset dataset = test::SimulateOrDie(simulator, 1);
  for (const SmootherLandmark landmark : kLandmarks) {
    SmootherEstimator estimator(MakeConfig(landmark), dataset.rig);
    NavEstimate start = test::DrawInitialState(dataset, 1, 0);
    start.bias.accel += Eigen::Vector3d(0.3, -0.3, 0.2);
    start.covariance.bottomRightCorner<3, 3>().diagonal().setConstant(0.25);
    for (const ImuSample& sample : dataset.imu) {
      ASSERT_TRUE(estimator.AddImu(sample).ok());
    }
    ASSERT_TRUE(estimator.Initialize(start).ok());
    for (size_t i = 0; i < 40; ++i) {
      ASSERT_TRUE(estimator.AddFrame(dataset.frames[i]).ok());
    }
    EXPECT_LT((estimator.Latest().nav.p_WB - start.nav.p_WB).norm(), 0.05);
    EXPECT_GT(estimator.last_statistics().features_used, 15);
  }
}

TEST(SmootherEstimatorTest, FramesThatAreNotKeyframesLeaveTheWindow) {
  const Dataset dataset = MakeSequence({.duration_s = 4});
  EstimatorConfig config = MakeConfig(SmootherLandmark::kInverseDepth);
  config.smoother.keyframe_parallax_px = 500;
  config.smoother.keyframe_min_tracked = 0;
  SmootherEstimator estimator(config, dataset.rig);
  for (const ImuSample& sample : dataset.imu) {
    ASSERT_TRUE(estimator.AddImu(sample).ok());
  }
  ASSERT_TRUE(estimator.Initialize(test::DrawInitialState(dataset, 1, 0)).ok());
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(estimator.AddFrame(dataset.frames[static_cast<size_t>(i)]).ok());
    EXPECT_EQ(estimator.Latest().stamp_ns, dataset.frames[static_cast<size_t>(i)].stamp_ns);
  }
  ASSERT_EQ(estimator.window().size(), 3);
  const WindowFrame& newest = estimator.window().newest();
  EXPECT_EQ(newest.imu.front().stamp_ns, estimator.window().frame(1).stamp_ns)
      << "their IMU joined the next interval";
  EXPECT_EQ(newest.imu.back().stamp_ns, newest.stamp_ns);
  EXPECT_NEAR(newest.preintegration->duration_s(), 0.6, 1e-9);
}

// GIVEN a range of depths that no landmark is in, and outliers, WHEN the gate refuses a track that was
// degenerate and had an assumed depth, THEN it is counted once.
TEST(SmootherEstimatorTest, ADegenerateTrackThatTheGateRefusesIsCountedOnce) {
  SimulatorConfig simulator;
  simulator.duration_s = 8;
  simulator.path_m = 10;
  simulator.outlier_rate = 0.02;
  const Dataset dataset = test::SimulateOrDie(simulator, 3);
  EstimatorConfig config = MakeConfig(SmootherLandmark::kPoseOnly);
  config.smoother.frames = FramePolicy::kEveryFrame;
  config.vision.min_depth_m = 200;
  config.vision.max_depth_m = 100;
  config.vision.max_relative_depth_deviation = 10;  // hardly any waits
  SmootherEstimator estimator(config, dataset.rig);
  for (const ImuSample& sample : dataset.imu) {
    ASSERT_TRUE(estimator.AddImu(sample).ok());
  }
  ASSERT_TRUE(estimator.Initialize(test::DrawInitialState(dataset, 3)).ok());
  int refused = 0;
  int waiting = 0;
  for (const TrackFrame& frame : dataset.frames) {
    ASSERT_TRUE(estimator.AddFrame(frame).ok());
    int examined = 0;
    for (const auto& [id, track] : estimator.window().tracks()) {
      examined += track.views.size() != 1 ? 1 : 0;
      refused += track.views.empty() ? 1 : 0;
    }
    const FrameStatistics& statistics = estimator.last_statistics();
    EXPECT_LE(statistics.features_degenerate + statistics.features_gated, examined);
    waiting += statistics.features_waiting;
  }
  EXPECT_GT(refused, waiting + 20);
}

TEST(SmootherEstimatorTest, BadInputIsAStatusAndLeavesTheStateAlone) {
  const Dataset dataset = MakeSequence({.duration_s = 2});
  const EstimatorConfig config = MakeConfig(SmootherLandmark::kInverseDepth);
  SmootherEstimator estimator(config, dataset.rig);
  EXPECT_EQ(estimator.AddFrame(dataset.frames.front()).code(), StatusCode::kDiverged);

  const NavEstimate good = test::DrawInitialState(dataset, 1, 0);
  NavEstimate bad = good;
  bad.nav.p_WB.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(estimator.Initialize(bad).code(), StatusCode::kInput);
  bad = good;
  bad.nav.R_WB *= 1.01;
  EXPECT_EQ(estimator.Initialize(bad).code(), StatusCode::kInput);
  bad = good;
  bad.covariance(0, 1) += 1;
  EXPECT_EQ(estimator.Initialize(bad).code(), StatusCode::kInput);
  bad = good;
  bad.covariance(3, 3) = -1;
  EXPECT_EQ(estimator.Initialize(bad).code(), StatusCode::kInput);
  EXPECT_FALSE(estimator.initialized());

  ASSERT_TRUE(estimator.Initialize(good).ok());
  TrackFrame late = dataset.frames[1];
  EXPECT_EQ(estimator.AddFrame(late).code(), StatusCode::kInput) << "no IMU reaches the frame";
  EXPECT_TRUE(estimator.initialized());
  EXPECT_EQ(estimator.Latest().stamp_ns, good.stamp_ns);
  for (const ImuSample& sample : dataset.imu) {
    ASSERT_TRUE(estimator.AddImu(sample).ok());
  }
  ASSERT_TRUE(estimator.AddFrame(late).ok());
  EXPECT_EQ(estimator.AddFrame(late).code(), StatusCode::kInput) << "the same frame again";
  EXPECT_EQ(estimator.Latest().stamp_ns, late.stamp_ns);
  TrackFrame invalid = dataset.frames[2];
  invalid.observations.front().pixel.x() = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(estimator.AddFrame(invalid).ok());
  EXPECT_EQ(estimator.last_statistics().observations_invalid, 1);
}

}  // namespace
}  // namespace alidade
