#include <gtest/gtest.h>

#include <cmath>

#include "eval/config/config_yaml.h"
#include "filter/filter_estimator.h"
#include "tests/support/scenario.h"

// Starts whose velocity is about as uncertain as the motion is fast (docs/track_memory.md).

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kDeviation_mps = 0.05;  // of the start's velocity
// Rounding at some kilometres, over the corrections of five seconds.
constexpr double kOriginTolerance = 1e-6;

/// A figure-8 at 0.1 m/s with landmarks within a few metres.
Dataset Crawl(double duration_s, double pixel_noise_px, unsigned seed) {
  const auto number = [](const char* key, double value) { return key + std::to_string(value); };
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/figure8.yaml",
                          {number("duration_s=", duration_s), number("path_m=", 0.1 * duration_s),
                           "length_m=3", "width_m=1.5", "height_m=0.15", "landmark_min_distance_m=1",
                           "landmark_max_distance_m=6", number("pixel_noise_px=", pixel_noise_px)});
  EXPECT_TRUE(sim.ok()) << sim.message();
  return test::SimulateOrDie(*sim, seed);
}

EstimatorConfig Config(double pixel_noise_px) {
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/alidade_filter.yaml",
                          {"vision.pixel_noise_px=" + std::to_string(pixel_noise_px)});
  EXPECT_TRUE(config.ok()) << config.message();
  return *config;
}

NavEstimate Start(const Dataset& dataset, unsigned seed, const Vector3d& velocity_error) {
  NavEstimate initial = test::DrawInitialState(dataset, seed);
  initial.nav.v_WB += velocity_error;
  initial.covariance.diagonal().segment<3>(6).setConstant(kDeviation_mps * kDeviation_mps);
  initial.covariance.diagonal().segment<3>(12).setConstant(0.1 * 0.1);
  return initial;
}

// GIVEN tracks that determine the direction u of the velocity and a start N(v, sigma^2) of it THEN the speed
// after the first update is where the start's density along u, s^2 exp(-(s - u.v)^2 / 2 sigma^2), is largest.
TEST(UncertainStartTest, TheFirstUpdateFindsTheMostLikelySpeed) {
  constexpr double kPixelNoise_px = 0.1;
  const Dataset dataset = Crawl(1, kPixelNoise_px, 1);
  const Vector3d truth = dataset.truth->points.front().nav.v_WB;
  const Vector3d across = truth.unitOrthogonal();
  for (const double share : {0.3, 0.6, 1.0}) {
    const Vector3d error = (share - 1) * truth + 0.8 * kDeviation_mps * across;
    FilterEstimator filter(Config(kPixelNoise_px), dataset.rig);
    const test::ScenarioResult result = test::RunScenario(dataset, Start(dataset, 1, error), &filter);
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    const double along = share * truth.norm();
    const double expected = (along + std::sqrt(along * along + 8 * kDeviation_mps * kDeviation_mps)) / 2;
    EXPECT_NEAR(result.last.nav.v_WB.norm(), expected, 0.1 * expected) << share;
  }
}

// GIVEN a start far from the origin, and corrections as large as an uncertain start needs them THEN the
// states are those of a start at the origin, with remembered tracks and with landmarks of the state.
TEST(UncertainStartTest, TheOriginDoesNotMatter) {
  constexpr double kPixelNoise_px = 0.7;
  const Vector3d far(3000, -2000, 50);
  const Dataset dataset = Crawl(5, kPixelNoise_px, 2);
  const NavEstimate start = Start(dataset, 2, Vector3d(0.05, -0.05, 0.05));
  for (const int slam_features : {0, 20}) {
    EstimatorConfig config = Config(kPixelNoise_px);
    if (slam_features > 0) {
      config.filter.slam_features = slam_features;
      config.filter.slam_max_depth_deviation = 0.3;
      config.filter.track_memory = TrackMemoryPolicy::kNone;
      config.filter.max_direction_deviation = 0;
    }
    const auto end = [&](const Vector3d& shift) {
      NavEstimate shifted = start;
      shifted.nav.p_WB += shift;
      FilterEstimator filter(config, dataset.rig);
      const test::ScenarioResult result = test::RunScenario(dataset, shifted, &filter);
      EXPECT_TRUE(result.status.ok()) << result.status.message();
      EXPECT_EQ(filter.state().landmarks().empty(), slam_features == 0);
      return result.last.nav;
    };
    const NavState near = end(Vector3d::Zero());
    const NavState there = end(far);
    EXPECT_LT((there.p_WB - far - near.p_WB).norm(), kOriginTolerance) << slam_features;
    EXPECT_LT((there.v_WB - near.v_WB).norm(), kOriginTolerance) << slam_features;
    EXPECT_LT((there.R_WB - near.R_WB).norm(), kOriginTolerance) << slam_features;
  }
}

// GIVEN starts one deviation off in each axis of the velocity THEN the scale neither vanishes nor grows.
TEST(UncertainStartTest, AnUncertainScaleStaysNearTheTrueOne) {
  constexpr double kPixelNoise_px = 0.7;
  constexpr unsigned kRuns = 8;
  double nees = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Dataset dataset = Crawl(20, kPixelNoise_px, seed);
    const Vector3d signs((seed & 1U) != 0 ? 1 : -1, (seed & 2U) != 0 ? 1 : -1, (seed & 4U) != 0 ? 1 : -1);
    FilterEstimator filter(Config(kPixelNoise_px), dataset.rig);
    const test::ScenarioResult result =
        test::RunScenario(dataset, Start(dataset, seed, kDeviation_mps * signs), &filter);
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    EXPECT_GT(result.scale, 0.5) << seed;
    EXPECT_LT(result.scale, 2) << seed;
    nees += result.nees_pose / kRuns;
  }
  EXPECT_LT(nees, 15);
}

}  // namespace
}  // namespace alidade
