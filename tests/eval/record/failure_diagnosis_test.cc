#include "eval/record/failure_diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scenario.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

/// Half a minute of figure-8 after three seconds at rest, with the accelerometer's axes times `signs`.
MeasurementLog LogWithSigns(const Eigen::Vector3d& signs) {
  SimulatorConfig simulation;
  simulation.duration_s = 30;
  simulation.rest_s = 3;
  simulation.path_m = 35;
  simulation.max_features = 80;
  const Dataset dataset = SimulateOrDie(simulation, 9);
  MeasurementLog log{dataset.rig, dataset.imu, dataset.frames};
  for (ImuSample& sample : log.imu) {
    sample.accel = sample.accel.cwiseProduct(signs);
  }
  return log;
}

EstimatorConfig SmallFilter() {
  EstimatorConfig config;
  config.filter.window = 10;
  return config;
}

TEST(FailureDiagnosisTest, ANegatedAccelerometerIsNamed) {
  const MeasurementLog log = LogWithSigns({-1, -1, -1});
  const RunResult failed = RunEstimator(SmallFilter(), log, {});
  EXPECT_TRUE(Failed(failed));
  const std::optional<std::string> cause =
      DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), failed, {});
  ASSERT_TRUE(cause.has_value());
  EXPECT_THAT(*cause, HasSubstr("with all axes of the accelerometer negated"));
}

TEST(FailureDiagnosisTest, ANegatedAxisIsNamed) {
  const MeasurementLog log = LogWithSigns({1, 1, -1});
  const RunResult failed = RunEstimator(SmallFilter(), log, {});
  const std::optional<std::string> cause =
      DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), failed, {});
  ASSERT_TRUE(cause.has_value());
  EXPECT_THAT(*cause, HasSubstr("z axis negated"));
}

// GIVEN an IMU that tells nonsense in the middle of a log WHEN the run is lost there THEN its signs are not
// blamed: it was sound before.
TEST(FailureDiagnosisTest, ALossAfterSoundMotionIsNotBlamedOnSigns) {
  MeasurementLog log = LogWithSigns({1, 1, 1});
  const TimeNs begin_ns = log.imu.front().stamp_ns + SecondsToNs(14), end_ns = begin_ns + SecondsToNs(1);
  for (ImuSample& sample : log.imu) {
    if (sample.stamp_ns > begin_ns && sample.stamp_ns < end_ns) {
      sample.accel *= -2;
      sample.gyro = Eigen::Vector3d(2, -3, 1);
    }
  }
  const RunResult failed = RunEstimator(SmallFilter(), log, {});
  ASSERT_TRUE(Failed(failed));
  EXPECT_FALSE(DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), failed, {}).has_value());
}

TEST(FailureDiagnosisTest, ALogThatRunsIsNotQuestioned) {
  const MeasurementLog log = LogWithSigns({1, 1, 1});
  const RunResult result = RunEstimator(SmallFilter(), log, {});
  EXPECT_FALSE(Failed(result)) << result.status.message();
  EXPECT_FALSE(DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), result, {}).has_value());
}

TEST(FailureDiagnosisTest, WithoutACameraThereIsNothingToCompare) {
  MeasurementLog log = LogWithSigns({1, 1, 1});
  log.frames.clear();
  EXPECT_FALSE(DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), {}, {}).has_value());
}

}  // namespace
}  // namespace alidade::test
