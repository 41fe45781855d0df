#include "filter/filter_estimator.h"

#include <gtest/gtest.h>

#include "filter/filter.h"
#include "tests/support/scenario.h"
#include "tests/support/short_figure_eight.h"

namespace alidade {
namespace {

using test::ScenarioResult;
using test::ShortFigureEight;

EstimatorConfig FilterPreset(FilterLandmark landmark, UpdateTiming update, int min_observations) {
  EstimatorConfig config;
  config.filter.landmark = landmark;
  config.filter.update = update;
  config.filter.min_observations = min_observations;
  config.filter.clone_policy =
      update == UpdateTiming::kImmediate ? ClonePolicy::kKeepBases : ClonePolicy::kOldest;
  return config;
}

ScenarioResult RunFilter(const EstimatorConfig& config, const Dataset& dataset, unsigned seed,
                         double scale = 1) {
  const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig);
  return test::RunScenario(dataset, test::DrawInitialState(dataset, seed, scale), filter.get());
}

struct Strategy {
  const char* name;
  FilterLandmark landmark;
  UpdateTiming update;
  int min_observations;
};

class EveryStrategy : public ::testing::TestWithParam<std::tuple<Strategy, ErrorConvention>> {};
INSTANTIATE_TEST_SUITE_P(
    Strategies, EveryStrategy,
    ::testing::Combine(
        ::testing::Values(Strategy{"multi", FilterLandmark::kPoseOnlyMulti, UpdateTiming::kImmediate, 4},
                          Strategy{"two", FilterLandmark::kPoseOnlyTwo, UpdateTiming::kImmediate, 4},
                          Strategy{"two_delayed", FilterLandmark::kPoseOnlyTwo, UpdateTiming::kDelayedAll, 4},
                          Strategy{"msckf", FilterLandmark::kMsckf, UpdateTiming::kDelayedAll, 5},
                          Strategy{"at_l", FilterLandmark::kMsckf, UpdateTiming::kAtL, 10}),
        ::testing::Values(ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant,
                          ErrorConvention::kSo3xRn)),
    [](const auto& test_case) {
      return std::string(std::get<0>(test_case.param).name) + "_" +
             std::string(ToString(std::get<1>(test_case.param)));
    });

TEST_P(EveryStrategy, NoiseFreeDataKeepTheTruth) {
  SimulatorConfig sim = ShortFigureEight();
  sim.duration_s = 15;
  sim.path_m = 20;
  sim.pixel_noise_px = 0;
  sim.imu_noise = {0, 0, 0, 0};
  const Dataset dataset = test::SimulateOrDie(sim, 1);
  const Strategy& strategy = std::get<0>(GetParam());
  EstimatorConfig config = FilterPreset(strategy.landmark, strategy.update, strategy.min_observations);
  config.filter.error = std::get<1>(GetParam());
  config.vision.robust_kernel = RobustKernel::kNone;
  Dataset with_noise_model = dataset;
  with_noise_model.rig.imu_noise = ImuNoise();
  const ScenarioResult result = RunFilter(config, with_noise_model, 1, 0);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_LT(result.max_position_m, 2e-3) << "what is left is the integration of IMU between samples";
}

TEST_P(EveryStrategy, TruthStaysInsideTheCovariance) {
  const Strategy& strategy = std::get<0>(GetParam());
  EstimatorConfig config = FilterPreset(strategy.landmark, strategy.update, strategy.min_observations);
  config.filter.error = std::get<1>(GetParam());
  double nees = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const ScenarioResult result = RunFilter(config, test::SimulateOrDie(ShortFigureEight(), seed), seed);
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    EXPECT_LT(result.rmse_position_m, 0.12);
    nees += result.nees_pose / 3;
  }
  EXPECT_GT(nees, 2.0);
  EXPECT_LT(nees, 11.0);
}

TEST(FilterEstimatorTest, PaperReuseIsOverconfidentAndInflationIsNot) {
  const auto mean_nees = [](BaseReuse reuse) {
    double nees = 0;
    for (unsigned seed = 1; seed <= 4; ++seed) {
      EstimatorConfig config = FilterPreset(FilterLandmark::kPoseOnlyMulti, UpdateTiming::kImmediate, 4);
      config.filter.base_reuse = reuse;
      config.vision.max_relative_depth_deviation = 0.05;  // poorer depths blur the comparison
      nees += RunFilter(config, test::SimulateOrDie(ShortFigureEight(), seed), seed).nees_pose / 4;
    }
    return nees;
  };
  EXPECT_GT(mean_nees(BaseReuse::kPaper), 1.2 * mean_nees(BaseReuse::kInflate));
}

TEST(FilterEstimatorTest, SameInputSameBits) {
  const Dataset dataset = test::SimulateOrDie(ShortFigureEight(), 5);
  const EstimatorConfig config = FilterPreset(FilterLandmark::kPoseOnlyMulti, UpdateTiming::kImmediate, 4);
  const ScenarioResult first = RunFilter(config, dataset, 5);
  const ScenarioResult second = RunFilter(config, dataset, 5);
  EXPECT_EQ(first.last.nav.p_WB, second.last.nav.p_WB);
  EXPECT_EQ(first.last.covariance, second.last.covariance);
}

TEST(FilterEstimatorTest, StandingStillStays) {
  SimulatorConfig sim = ShortFigureEight();
  sim.rest_s = 25;
  sim.duration_s = 27.5;  // it sets off in the last two seconds
  sim.path_m = 1;
  EstimatorConfig config = FilterPreset(FilterLandmark::kPoseOnlyMulti, UpdateTiming::kImmediate, 4);
  constexpr unsigned kRuns = 10;
  double mean_m = 0;
  for (unsigned seed = 10; seed < 10 + kRuns; ++seed) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    config.vision.rest_updates = true;
    const ScenarioResult result = RunFilter(config, dataset, seed);
    ASSERT_TRUE(result.status.ok());
    mean_m += result.max_position_m / kRuns;
    config.vision.rest_updates = false;
    EXPECT_GT(RunFilter(config, dataset, seed).max_position_m, 0.1)
        << "without the rest updates nothing holds it, seed " << seed;
  }
  EXPECT_LT(mean_m, 0.06);
}

TEST(FilterEstimatorTest, OutliersAreGated) {
  SimulatorConfig sim = ShortFigureEight();
  sim.outlier_rate = 0.05;
  const Dataset dataset = test::SimulateOrDie(sim, 6);
  const ScenarioResult result =
      RunFilter(FilterPreset(FilterLandmark::kPoseOnlyMulti, UpdateTiming::kImmediate, 4), dataset, 6);
  ASSERT_TRUE(result.status.ok());
  EXPECT_LT(result.rmse_position_m, 0.2);
}

// GIVEN vision.noise: adaptive WHEN 30 % of the tracks jump about for 5 s, THEN the noise moves by no more
// than its rate allows in that time, the truth is kept, and the same input gives the same bits.
TEST(FilterEstimatorTest, WrongTracksDoNotRaiseTheAdaptiveNoise) {
  EstimatorConfig config = FilterPreset(FilterLandmark::kPoseOnlyMulti, UpdateTiming::kImmediate, 4);
  config.vision.noise = PixelNoiseModel::kAdaptive;
  Dataset dataset = test::SimulateOrDie(ShortFigureEight(), 6);
  const ScenarioResult clean = RunFilter(config, dataset, 6);
  ASSERT_TRUE(clean.status.ok());
  EXPECT_GE(clean.max_pixel_noise_px, config.vision.pixel_noise_px);
  EXPECT_LT(clean.max_pixel_noise_px, 1.1 * config.vision.pixel_noise_px);
  RandomStream random(6, "wrong tracks");
  const TimeNs start_ns = dataset.frames.front().stamp_ns + 15 * kSecondNs;
  for (TrackFrame& frame : dataset.frames) {
    for (TrackObservation& seen : frame.observations) {
      if (seen.track_id % 10 < 3 && frame.stamp_ns >= start_ns && frame.stamp_ns < start_ns + 5 * kSecondNs) {
        seen.pixel += 15 * Eigen::Vector2d(random.Normal(), random.Normal());
      }
    }
  }
  const ScenarioResult result = RunFilter(config, dataset, 6);
  ASSERT_TRUE(result.status.ok());
  EXPECT_LT(result.max_pixel_noise_px, 1.15 * config.vision.pixel_noise_px);
  EXPECT_LT(result.rmse_position_m, 0.2);
  EXPECT_EQ(RunFilter(config, dataset, 6).last.covariance, result.last.covariance);
}

TEST(FilterEstimatorTest, WindowNeverExceedsItsSize) {
  const Dataset dataset = test::SimulateOrDie(ShortFigureEight(), 7);
  for (const ClonePolicy policy : {ClonePolicy::kOldest, ClonePolicy::kKeepBases}) {
    EstimatorConfig config = FilterPreset(FilterLandmark::kPoseOnlyMulti, UpdateTiming::kImmediate, 4);
    config.filter.window = 8;
    config.filter.clone_policy = policy;
    FilterEstimator filter(config, dataset.rig);
    const ScenarioResult result = test::RunScenario(dataset, test::DrawInitialState(dataset, 7), &filter);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    EXPECT_EQ(filter.state().clones().size(), 8u);
    EXPECT_EQ(filter.state().covariance().dimension(), 15 + 6 * 8);
  }
}

TEST(FilterEstimatorTest, AFrameThatNoImuReachesIsSkippedAndNothingIsLost) {
  const Dataset dataset = test::SimulateOrDie(ShortFigureEight(), 8);
  FilterEstimator filter(FilterPreset(FilterLandmark::kMsckf, UpdateTiming::kDelayedAll, 5), dataset.rig);
  EXPECT_EQ(filter.AddFrame(dataset.frames[0]).code(), StatusCode::kDiverged) << "before Initialize";
  const NavEstimate initial = test::DrawInitialState(dataset, 8);
  ASSERT_TRUE(filter.Initialize(initial).ok());
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(filter.AddImu(dataset.imu[static_cast<size_t>(i)]).ok());
  }
  ASSERT_TRUE(filter.AddFrame(dataset.frames[0]).ok());
  const NavEstimate before = filter.Latest();
  EXPECT_EQ(filter.AddFrame(dataset.frames[20]).code(), StatusCode::kInput);
  EXPECT_EQ(filter.Latest().nav.p_WB, before.nav.p_WB);
  EXPECT_EQ(filter.AddFrame(dataset.frames[0]).code(), StatusCode::kInput) << "not after the last one";
  EXPECT_TRUE(filter.AddFrame(dataset.frames[1]).ok());
}

TEST(FilterEstimatorTest, BadInitialStatesAreRefused) {
  const Dataset dataset = test::SimulateOrDie(ShortFigureEight(), 9);
  FilterEstimator filter(EstimatorConfig(), dataset.rig);
  NavEstimate initial = test::DrawInitialState(dataset, 9);
  initial.nav.R_WB(0, 0) += 0.1;
  EXPECT_EQ(filter.Initialize(initial).code(), StatusCode::kInput);
  initial = test::DrawInitialState(dataset, 9);
  initial.nav.v_WB.x() = std::nan("");
  EXPECT_EQ(filter.Initialize(initial).code(), StatusCode::kInput);
  initial = test::DrawInitialState(dataset, 9);
  initial.nav.p_WB += Eigen::Vector3d(485e3, 5420e3, 0);  // UTM
  const Status far = filter.Initialize(initial);
  EXPECT_EQ(far.code(), StatusCode::kInput);
  EXPECT_NE(far.message().find("found 5442 km"), std::string::npos) << far.message();
  EXPECT_FALSE(filter.initialized());
}

}  // namespace
}  // namespace alidade
