#include <gtest/gtest.h>

#include "filter/filter_estimator.h"
#include "tests/support/scenario.h"
#include "tests/support/short_figure_eight.h"

// The whole filter with landmarks in its state, on simulated data.

namespace alidade {
namespace {

using test::ShortFigureEight;

EstimatorConfig SlamPreset(ErrorConvention convention, bool first_estimates, int slam_features) {
  EstimatorConfig config;
  config.filter.error = convention;
  config.filter.first_estimates = first_estimates;
  config.filter.landmark = FilterLandmark::kMsckf;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.clone_policy = ClonePolicy::kOldest;
  config.filter.window = 11;
  config.filter.slam_features = slam_features;
  return config;
}

TEST(SlamFilterTest, TruthStaysInsideTheCovarianceAndLandmarksHelp) {
  const auto run = [](ErrorConvention convention, bool first_estimates, int slam_features) {
    test::ScenarioResult sum;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Dataset dataset = test::SimulateOrDie(ShortFigureEight(), seed);
      FilterEstimator filter(SlamPreset(convention, first_estimates, slam_features), dataset.rig);
      const test::ScenarioResult result =
          test::RunScenario(dataset, test::DrawInitialState(dataset, seed), &filter);
      EXPECT_TRUE(result.status.ok()) << result.status.message();
      EXPECT_LE(filter.state().landmarks().size(), static_cast<size_t>(slam_features));
      sum.nees_pose += result.nees_pose / 3;
      sum.rmse_position_m += result.rmse_position_m / 3;
    }
    return sum;
  };
  const test::ScenarioResult without = run(ErrorConvention::kRightInvariant, false, 0);
  const test::ScenarioResult invariant = run(ErrorConvention::kRightInvariant, false, 20);
  const test::ScenarioResult first = run(ErrorConvention::kSo3xRn, true, 20);
  const test::ScenarioResult neither = run(ErrorConvention::kSo3xRn, false, 20);
  EXPECT_LT(invariant.rmse_position_m, 0.9 * without.rmse_position_m);
  EXPECT_LT(first.rmse_position_m, 0.9 * without.rmse_position_m);
  EXPECT_LT(invariant.nees_pose, 9.0);
  EXPECT_LT(first.nees_pose, 9.0);
  EXPECT_GT(neither.nees_pose, 1.2 * first.nees_pose) << "yaw is taken for observable";
}

TEST(SlamFilterTest, SameInputSameBits) {
  const Dataset dataset = test::SimulateOrDie(ShortFigureEight(), 5);
  const auto run = [&dataset] {
    FilterEstimator filter(SlamPreset(ErrorConvention::kSo3xRn, true, 30), dataset.rig);
    return test::RunScenario(dataset, test::DrawInitialState(dataset, 5), &filter);
  };
  const test::ScenarioResult first = run();
  const test::ScenarioResult second = run();
  EXPECT_EQ(first.last.nav.p_WB, second.last.nav.p_WB);
  EXPECT_EQ(first.last.covariance, second.last.covariance);
}

TEST(SlamFilterTest, LandmarksLeaveWithTheirTracksAndMismatchesAreRefused) {
  SimulatorConfig sim = ShortFigureEight();
  sim.outlier_rate = 0.05;
  const Dataset dataset = test::SimulateOrDie(sim, 6);
  EstimatorConfig config = SlamPreset(ErrorConvention::kRightInvariant, false, 30);
  FilterEstimator filter(config, dataset.rig);
  const test::ScenarioResult result = test::RunScenario(dataset, test::DrawInitialState(dataset, 6), &filter);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_LT(result.rmse_position_m, 0.2);
  EXPECT_GT(filter.state().landmarks().size(), 5u);
  TrackFrame empty;
  empty.stamp_ns = dataset.frames.back().stamp_ns + 50'000'000;
  ImuSample sample = dataset.imu.back();
  for (int i = 0; i < 10; ++i) {
    sample.stamp_ns += 10'000'000;
    ASSERT_TRUE(filter.AddImu(sample).ok());
  }
  ASSERT_TRUE(filter.AddFrame(empty).ok());
  EXPECT_TRUE(filter.state().landmarks().empty());
  EXPECT_EQ(filter.state().covariance().dimension(), 15 + 6 * config.filter.window);
}

// GIVEN landmarks in the state, WHEN an image is repeated, THEN the state moves on and keeps every landmark
// and clone: no track has ended.
TEST(SlamFilterTest, ARepeatedImageEndsNoTrack) {
  const Dataset dataset = test::SimulateOrDie(ShortFigureEight(), 6);
  FilterEstimator filter(SlamPreset(ErrorConvention::kRightInvariant, false, 30), dataset.rig);
  ASSERT_TRUE(test::RunScenario(dataset, test::DrawInitialState(dataset, 6), &filter).status.ok());
  const size_t landmarks = filter.state().landmarks().size();
  ASSERT_GT(landmarks, 5u);
  const auto dimension = filter.state().covariance().dimension();
  TrackFrame repeated;
  repeated.stamp_ns = dataset.frames.back().stamp_ns + 50'000'000;
  repeated.repeated = true;
  ImuSample sample = dataset.imu.back();
  for (int i = 0; i < 10; ++i) {
    sample.stamp_ns += 10'000'000;
    ASSERT_TRUE(filter.AddImu(sample).ok());
  }
  ASSERT_TRUE(filter.AddFrame(repeated).ok());
  EXPECT_EQ(filter.Latest().stamp_ns, repeated.stamp_ns);
  EXPECT_GT(filter.last_statistics().propagate_ms, 0);
  EXPECT_EQ(filter.state().landmarks().size(), landmarks);
  EXPECT_EQ(filter.state().covariance().dimension(), dimension);
  EXPECT_EQ(filter.AddFrame(repeated).code(), StatusCode::kInput) << "a stamp once";
}

}  // namespace
}  // namespace alidade
