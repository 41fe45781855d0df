#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "eval/comparison/cell_score.h"
#include "eval/config/config_yaml.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"

namespace alidade {
namespace {

Dataset Walk(unsigned seed) {
  const Result<SimulatorConfig> config =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/gnss_figure8_short.yaml",
                          {"duration_s=20", "path_m=80", "gnss.clock_jump_at_s=10", "gnss.nlos_rate=0.1"});
  EXPECT_TRUE(config.ok()) << config.message();
  Result<Dataset> dataset = Simulate(*config, seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return *std::move(dataset);
}

CellResult Score(const std::string& preset, const Dataset& dataset, unsigned seed) {
  const Result<EstimatorConfig> config = LoadEstimatorConfig(
      ALIDADE_SOURCE_DIR "/configs/estimators/" + preset + ".yaml",
      {"gnss.enabled=true", "gnss.model_std_scale=0", "gnss.pseudorange_std_m=0.5", "init.method=truth"});
  EXPECT_TRUE(config.ok()) << config.message();
  RunOptions options;
  options.seed = seed;
  options.truth = &*dataset.truth;
  const RunResult run = RunEstimator(*config, MeasurementsOf(dataset), options);
  EvaluationOptions evaluation;
  evaluation.alignment = TrajectoryAlignment::kNone;
  CellResult cell;
  ScoreRun(&*dataset.truth, run, evaluation, &cell);
  EXPECT_EQ(cell.status, "ok") << preset << ", seed " << seed << ": " << cell.message;
  return cell;
}

// GIVEN GNSS with reflections and a jump of the receiver's clock THEN the batch estimate is consistent, and
// better than the filter that has no later data.
TEST(BatchGnss, BoundsTheFilter) {
  constexpr unsigned kRuns = 4;
  double nees = 0;
  double batch_m2 = 0;
  double filter_m2 = 0;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    const Dataset dataset = Walk(seed);
    const CellResult batch = Score("batch", dataset, seed);
    const CellResult filter = Score("gvio", dataset, seed);
    ASSERT_TRUE(batch.rmse_pos_m && batch.nees_pose && filter.rmse_pos_m);
    nees += *batch.nees_pose / kRuns;
    batch_m2 += *batch.rmse_pos_m * *batch.rmse_pos_m;
    filter_m2 += *filter.rmse_pos_m * *filter.rmse_pos_m;
  }
  EXPECT_LT(batch_m2, filter_m2);
  EXPECT_GT(nees, 2);
  EXPECT_LT(nees, 12);
}

}  // namespace
}  // namespace alidade
