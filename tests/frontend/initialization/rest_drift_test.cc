#include <gtest/gtest.h>

#include <iostream>

#include "eval/frontend_run/image_pipeline.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {
namespace {

class RestDrift : public testing::TestWithParam<Backend> {};

// GIVEN a rig at rest for a minute, WHEN it starts by itself, THEN it stays where it is to 5 cm.
TEST_P(RestDrift, GIVEN_a_minute_of_rest_THEN_the_drift_stays_below_five_centimetres) {
  SimulatorConfig simulator;
  simulator.duration_s = 66;
  simulator.rest_s = 62;
  simulator.path_m = 5;
  const Result<Dataset> dataset = Simulate(simulator, 700);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const Result<MeasurementLog> log = MakeLog(*dataset, FrontendConfig(), {});
  ASSERT_TRUE(log.ok()) << log.message();
  EstimatorConfig config;
  config.backend = GetParam();
  config.init.method = InitMethod::kAuto;
  const RunResult result = RunEstimator(config, *log, nullptr, 1);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  ASSERT_EQ(result.init_method, "static") << result.init_report;
  double drift_m = 0;
  const TimeNs rest_ends = log->frames.front().stamp_ns + SecondsToNs(61.5);
  size_t at_rest = 0;
  for (; at_rest < result.records.size() && result.records[at_rest].estimate.stamp_ns < rest_ends;
       ++at_rest) {
    drift_m = std::max(
        drift_m,
        (result.records[at_rest].estimate.nav.p_WB - result.records.front().estimate.nav.p_WB).norm());
  }
  EXPECT_GT(at_rest, 590U) << "a minute at 10 Hz";
  std::cout << "  " << ToString(GetParam()) << ": largest distance from the start " << drift_m << " m\n";
  EXPECT_LT(drift_m, 0.05);
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, RestDrift, testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade
