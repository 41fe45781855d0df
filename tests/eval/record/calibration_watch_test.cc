#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/eval/record/estimator_runs.h"

// What calibration.watch reports and what it leaves alone, with both back ends.

namespace alidade {
namespace {

using testing::HasSubstr;

SimulatorConfig Walk() {
  SimulatorConfig config;
  config.duration_s = 20;
  config.path_m = 26;
  return config;
}

EstimatorConfig Estimating(Backend backend, bool watch) {
  EstimatorConfig config = test::CarryingEstimator(backend);
  config.smoother.landmark = SmootherLandmark::kPoseOnly;
  config.smoother.slam_features = 20;
  config.calibration.watch = watch;
  return config;
}

RunResult RunOn(const SimulatorConfig& simulation, const EstimatorConfig& config) {
  const Result<Dataset> dataset = Simulate(simulation, 107);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return test::RunOn(config, *dataset, 107);
}

class CalibrationWatchRunTest : public testing::TestWithParam<Backend> {};

// GIVEN a camera as in its sheet, WHEN it is watched, THEN nothing is degraded, nothing of the calibration
// is written, and the estimate is what it is without.
TEST_P(CalibrationWatchRunTest, LeavesARunAloneWhoseCameraIsAsGiven) {
  const RunResult plain = RunOn(Walk(), Estimating(GetParam(), false));
  const RunResult watched = RunOn(Walk(), Estimating(GetParam(), true));
  ASSERT_EQ(watched.records.size(), plain.records.size());
  for (size_t i = 0; i < plain.records.size(); ++i) {
    const NavEstimate& a = plain.records[i].estimate;
    const NavEstimate& b = watched.records[i].estimate;
    EXPECT_EQ(a.stamp_ns, b.stamp_ns);
    EXPECT_EQ(watched.records[i].status, "ok") << watched.records[i].reason;
    EXPECT_FALSE(watched.records[i].calibration);
    const Eigen::Vector3d deviations = a.covariance.diagonal().segment<3>(3).cwiseSqrt();
    ASSERT_LT((a.nav.p_WB - b.nav.p_WB).cwiseQuotient(deviations).norm(), 2e-3) << i;
    ASSERT_LT((a.covariance - b.covariance).norm(), 2e-3 * a.covariance.norm()) << i;
  }
}

// GIVEN a focal length 1 % off, a time offset of 10 ms, THEN the run reports which it is, and by how much.
TEST_P(CalibrationWatchRunTest, NamesWhatIsWrong) {
  SimulatorConfig focal = Walk();
  focal.calibration_focal_error_px = 4.6;
  SimulatorConfig late = Walk();
  late.calibration_time_error_s = 0.01;
  for (const auto& [simulation, name] :
       {std::pair(focal, "the focal length of the camera is not as given: off by"),
        std::pair(late, "the time offset of the camera is not as given: off by")}) {
    const RunResult result = RunOn(simulation, Estimating(GetParam(), true));
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    EXPECT_EQ(result.records.back().status, "degraded");
    EXPECT_THAT(result.records.back().reason, HasSubstr(name));
    EXPECT_EQ(result.records.back().degradation, DegradationKind::kModel);
    const auto degraded = std::count_if(result.records.begin(), result.records.end(),
                                        [](const RunRecord& record) { return record.status == "degraded"; });
    EXPECT_GT(degraded, 50) << "of 200 frames";
  }
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, CalibrationWatchRunTest,
                         testing::Values(Backend::kFilter, Backend::kSmoother), [](const auto& param) {
                           return param.param == Backend::kFilter ? "filter" : "smoother";
                         });

}  // namespace
}  // namespace alidade
