#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/metrics/nees.h"
#include "eval/record/recorder.h"
#include "eval/record/recorder_reader.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "eval/trajectory/trajectory_point.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

SimulatorConfig Failing(SimFaultKind fault, double duration_s) {
  SimulatorConfig config;
  config.duration_s = 25;
  config.path_m = 1.31 * config.duration_s;
  config.wobble_rad = 0.15;
  config.fault = fault;
  config.fault_start_s = 8;
  config.fault_duration_s = duration_s;
  return config;
}

EstimatorConfig Config(Backend backend) {
  EstimatorConfig config;
  config.backend = backend;
  config.init.method = InitMethod::kTruth;
  config.smoother.landmark = SmootherLandmark::kPoseOnly;
  config.recovery.max_suspect_s = 1;
  return config;
}

RunResult RunOn(const EstimatorConfig& config, const Dataset& dataset) {
  return RunEstimator(config, {dataset.rig, dataset.imu, dataset.frames}, &*dataset.truth, 101);
}

/// Speed error of a record; unlike position, a new start determines it.
double SpeedError(const RunRecord& record, const Dataset& dataset) {
  const Result<TrajectoryPoint> truth = InterpolateTruth(*dataset.truth, record.estimate.stamp_ns);
  EXPECT_TRUE(truth.ok());
  return std::abs(truth->nav.v_WB.norm() - record.estimate.nav.v_WB.norm());
}

/// Mean pose NEES of the records from a stamp on.
double MeanNees(const RunResult& result, TimeNs from_ns, const Dataset& dataset) {
  std::vector<StatePair> pairs;
  for (const RunRecord& record : result.records) {
    const Result<TrajectoryPoint> truth = InterpolateTruth(*dataset.truth, record.estimate.stamp_ns);
    if (record.estimate.stamp_ns >= from_ns && truth.ok()) {
      pairs.push_back({*truth, PointOf(record.estimate)});
    }
  }
  EXPECT_GT(pairs.size(), 20U);
  return ComputeNees(pairs).mean_pose;
}

class RecoveryRunTest : public testing::TestWithParam<Backend> {};

// GIVEN a camera that sees nothing and an IMU that measures noise for two seconds, WHEN both come back, THEN
// the run reports when and why it was lost, starts again and is right about its speed to the end.
TEST_P(RecoveryRunTest, StartsAgainAfterCameraAndImuFailed) {
  const Result<Dataset> dataset = Simulate(Failing(SimFaultKind::kBlackoutAndImu, 2), 101);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const RunResult result = RunOn(Config(GetParam()), *dataset);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  ASSERT_FALSE(result.restarts.empty());
  const Restart& restart = result.restarts.front();
  const TimeNs failed_ns = dataset->imu.front().stamp_ns + SecondsToNs(8);
  EXPECT_GT(restart.lost_ns, failed_ns);
  EXPECT_LT(SecondsBetween(failed_ns, restart.lost_ns), 6);
  EXPECT_GT(restart.restarted_ns, restart.lost_ns);
  EXPECT_FALSE(restart.reason.empty());
  EXPECT_GT(result.records.back().estimate.stamp_ns, dataset->frames.back().stamp_ns - SecondsToNs(0.2));
  EXPECT_LT(SpeedError(result.records.back(), *dataset), 0.2);
  // Tens of metres off, and its covariance covers that: chi-square with 6 degrees of freedom, 1e-4
  // beyond 27.9.
  EXPECT_LT(MeanNees(result, restart.restarted_ns, *dataset), 27.9);
  int lost = 0;
  int restarted = 0;
  for (const RunRecord& record : result.records) {
    lost += record.status == "lost" ? 1 : 0;
    restarted += record.status == "restarted" ? 1 : 0;
  }
  EXPECT_EQ(lost, static_cast<int>(result.restarts.size()));
  EXPECT_EQ(restarted, static_cast<int>(result.restarts.size()));
}

TEST_P(RecoveryRunTest, NothingAbortsWhateverFails) {
  for (const SimFaultKind fault : {SimFaultKind::kBlackout, SimFaultKind::kImu, SimFaultKind::kTracks}) {
    const Result<Dataset> dataset = Simulate(Failing(fault, 2), 102);
    ASSERT_TRUE(dataset.ok()) << dataset.message();
    const RunResult result = RunOn(Config(GetParam()), *dataset);
    ASSERT_TRUE(result.status.ok()) << static_cast<int>(fault) << ": " << result.status.message();
    EXPECT_GT(result.records.back().estimate.stamp_ns, dataset->frames.back().stamp_ns - SecondsToNs(0.2));
    EXPECT_LT(SpeedError(result.records.back(), *dataset), 0.3) << static_cast<int>(fault);
  }
}

TEST_P(RecoveryRunTest, EndsTheRunWhenItIsOff) {
  const Result<Dataset> dataset = Simulate(Failing(SimFaultKind::kBlackoutAndImu, 2), 101);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  EstimatorConfig config = Config(GetParam());
  config.recovery.enabled = false;
  const RunResult result = RunOn(config, *dataset);
  EXPECT_TRUE(result.restarts.empty());
  for (const RunRecord& record : result.records) {
    EXPECT_NE(record.status, "restarted");
  }
}

TEST_P(RecoveryRunTest, StatusHoldsWhenAndWhy) {
  const Result<Dataset> dataset = Simulate(Failing(SimFaultKind::kBlackoutAndImu, 2), 103);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const EstimatorConfig config = Config(GetParam());
  const RunResult result = RunOn(config, *dataset);
  const test::TemporaryFolder folder;
  const RunIdentity identity{config, "walk", "d", "i", 101, dataset->imu.size(), dataset->frames.size()};
  ASSERT_TRUE(WriteRun(identity, result, folder.path()).ok());
  const std::string text = test::ReadFile(folder.path() + "/status.csv");
  EXPECT_THAT(text, HasSubstr(",lost,"));
  EXPECT_THAT(text, HasSubstr(",restarted,"));
  const Result<RunResult> read = ReadRun(folder.path());
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->restarts.size(), result.restarts.size());
  EXPECT_EQ(read->restarts.front().reason, result.restarts.front().reason);
  EXPECT_EQ(read->restarts.front().restarted_ns, result.restarts.front().restarted_ns);
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, RecoveryRunTest, testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& param) { return std::string(ToString(param.param)); });

}  // namespace
}  // namespace alidade
