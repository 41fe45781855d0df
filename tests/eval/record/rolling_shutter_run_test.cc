#include <gtest/gtest.h>

#include <cmath>

#include "eval/metrics/association.h"
#include "eval/metrics/nees.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/eval/record/estimator_runs.h"

// Estimators on images whose rows are exposed one after the other.

namespace alidade {
namespace {

using test::CarryingEstimator;
using test::EveryLandmark;
using test::NamedEstimator;
using test::RunOn;

constexpr double kLineDelayS = 0.02 / 480;

/// 20 s of the figure-8 with a camera that shakes and reads its rows out over 20 ms.
Dataset RollingScene(std::uint64_t seed) {
  SimulatorConfig config;
  config.duration_s = 20;
  config.path_m = 40;
  config.wobble_rad = 0.3;
  config.max_features = 80;
  config.render.line_delay_s = kLineDelayS;
  Result<Dataset> dataset = Simulate(config, seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  EXPECT_EQ(dataset->rig.line_delay_s, kLineDelayS);
  return *std::move(dataset);
}

struct Score {
  double rmse_m = 0;
  double nees = 0;
};

Score ScoreOf(const RunResult& result, const Dataset& dataset) {
  EXPECT_TRUE(result.status.ok()) << result.status.message();
  const Result<std::vector<StatePair>> pairs = Associate(*dataset.truth, TrajectoryOf(result), {});
  EXPECT_TRUE(pairs.ok()) << pairs.message();
  double squared = 0;
  for (const StatePair& pair : *pairs) {
    squared += (pair.truth.nav.p_WB - pair.estimate.nav.p_WB).squaredNorm();
  }
  return {std::sqrt(squared / static_cast<double>(pairs->size())), ComputeNees(*pairs).mean_pose};
}

// GIVEN a read-out of 20 ms WHEN each observation has its row's time THEN the covariance covers the error,
// and WHEN all rows are taken as exposed at once it does not.
TEST(RollingShutterRun, EveryEstimatorIsConsistentWithIt) {
  const Dataset dataset = RollingScene(907);
  for (const NamedEstimator& c : EveryLandmark()) {
    SCOPED_TRACE(c.name);
    const Score with = ScoreOf(RunOn(c.config, dataset, 907), dataset);
    EXPECT_LT(with.nees, 14) << "6 on average over runs";
    EstimatorConfig at_once = c.config;
    at_once.vision.rolling_shutter = false;
    const Score without = ScoreOf(RunOn(at_once, dataset, 907), dataset);
    EXPECT_GT(without.nees, 2 * with.nees);
    EXPECT_GT(without.rmse_m, 1.2 * with.rmse_m);
  }
}

// GIVEN a sheet whose read-out is 5 ms too short WHEN the line delay is estimated THEN it is found.
TEST(RollingShutterRun, TheLineDelayIsFound) {
  Dataset dataset = RollingScene(908);
  dataset.rig.line_delay_s = 0.75 * kLineDelayS;
  for (NamedEstimator& c : EveryLandmark()) {
    SCOPED_TRACE(c.name);
    c.config.calibration.line_delay = true;
    c.config.calibration.line_delay_std_s = 1e-5;
    const RunResult result = RunOn(c.config, dataset, 908);
    EXPECT_LT(ScoreOf(result, dataset).nees, 14);
    const CalibrationEstimate& estimate = *result.records.back().calibration;
    const double deviation_s = estimate.deviations[estimate.layout.line_delay()];
    const double error_s = *estimate.mean.line_delay_s - kLineDelayS;
    EXPECT_LT(std::abs(error_s), 0.12 * 0.25 * kLineDelayS) << "of what the sheet is off";
    EXPECT_LT(std::abs(error_s), 4 * deviation_s);
  }
}

// GIVEN no sheet of the truth's start WHEN the estimator starts in motion THEN it does so from the rows'
// times.
TEST(RollingShutterRun, AStartInMotionTakesTheRowsTimes) {
  const Dataset dataset = RollingScene(909);
  EstimatorConfig config = CarryingEstimator(Backend::kFilter);
  config.init.method = InitMethod::kDynamic;
  const RunResult result = RunOn(config, dataset, 909);
  ASSERT_TRUE(result.status.ok()) << result.status.message() << result.init_report;
  EXPECT_GT(result.records.size(), 100u);
}

}  // namespace
}  // namespace alidade
