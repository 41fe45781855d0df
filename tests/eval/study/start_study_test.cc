#include "eval/study/start_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "eval/frontend_run/image_pipeline.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {
namespace {

using ::testing::HasSubstr;

// GIVEN a simulated sequence, WHEN starts are drawn, THEN they are scored against its truth, equal seeds give
// equal starts, and the table counts them.
TEST(StartStudyTest, StartsAreEvaluatedAgainstTruthAndRepeat) {
  SimulatorConfig simulator;
  simulator.duration_s = 15;
  simulator.path_m = 20;
  const Result<Dataset> dataset = Simulate(simulator, 500);
  ASSERT_TRUE(dataset.ok());
  const Result<MeasurementLog> log = MakeLog(*dataset, FrontendConfig(), {});
  ASSERT_TRUE(log.ok());
  EstimatorConfig config;
  config.init.method = InitMethod::kDynamic;
  const auto starts = [&](unsigned seed) {
    return StartOften(config, *log, *dataset->truth, "figure8", 2, 6, seed);
  };
  const std::vector<StartOutcome> first = starts(3);
  const std::vector<StartOutcome> again = starts(3);
  ASSERT_EQ(first.size(), 2U);
  EXPECT_NE(first[0].start_ns, starts(4)[0].start_ns);
  EXPECT_EQ(StartCsv(first), StartCsv(again));
  for (const StartOutcome& outcome : first) {
    ASSERT_TRUE(outcome.found) << outcome.message;
    EXPECT_EQ(outcome.method, "dynamic");
    EXPECT_GE(outcome.waited_s, config.init.dynamic_window_s);
    EXPECT_LT(outcome.scale_error, 0.2);
    EXPECT_GT(outcome.scale_error, 0);
    EXPECT_LT(outcome.velocity_error_mps, 0.3);
    EXPECT_TRUE(std::isfinite(outcome.nees_all));
  }
  EXPECT_THAT(StartTable(first), HasSubstr("figure8"));
  EXPECT_THAT(StartTable(first), HasSubstr("all                 2      2        2"));
}

}  // namespace
}  // namespace alidade
