#include "eval/record/failure_diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/record/accelerometer_signs.h"
#include "tests/support/scenario.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

/// Figure-8 of 27 s after a rest, with the accelerometer's axes times `signs`.
MeasurementLog LogWithSigns(const Eigen::Vector3d& signs, double rest_s = 3) {
  SimulatorConfig simulation;
  simulation.duration_s = 27 + rest_s;
  simulation.rest_s = rest_s;
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

std::optional<std::string> CauseOf(const MeasurementLog& log, const RunResult& failed) {
  return DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), failed, {});
}

TEST(FailureDiagnosisTest, ANegatedAccelerometerIsNamed) {
  const MeasurementLog log = LogWithSigns({-1, -1, -1});
  const RunResult failed = RunEstimator(SmallFilter(), log, {});
  EXPECT_TRUE(Failed(failed));
  const std::optional<std::string> cause = CauseOf(log, failed);
  ASSERT_TRUE(cause.has_value());
  EXPECT_THAT(*cause, HasSubstr("with all axes of the accelerometer negated"));
}

TEST(FailureDiagnosisTest, ANegatedAxisIsNamed) {
  const MeasurementLog log = LogWithSigns({1, 1, -1});
  const RunResult failed = RunEstimator(SmallFilter(), log, {});
  const std::optional<std::string> cause = CauseOf(log, failed);
  ASSERT_TRUE(cause.has_value());
  EXPECT_THAT(*cause, HasSubstr("z axis negated"));
}

// GIVEN a rest that is longer than what is looked at WHEN the run is lost behind it THEN the data around the
// loss are looked at.
TEST(FailureDiagnosisTest, ALossAfterALongRestIsDiagnosedWhereItIs) {
  const MeasurementLog log = LogWithSigns({-1, -1, -1}, 40);
  const RunResult failed = RunEstimator(SmallFilter(), log, {});
  ASSERT_TRUE(Failed(failed));
  const std::optional<std::string> cause = CauseOf(log, failed);
  ASSERT_TRUE(cause.has_value());
  EXPECT_THAT(*cause, HasSubstr("with all axes of the accelerometer negated"));
}

// GIVEN a camera whose clock is 30 s ahead of the IMU's THEN the data around the loss are looked at all the
// same.
TEST(FailureDiagnosisTest, TheLossIsFoundInTheCamerasTime) {
  MeasurementLog log = LogWithSigns({-1, -1, -1}, 40);
  log.rig.camera_time_offset_s = -30;
  for (TrackFrame& frame : log.frames) {
    frame.stamp_ns += 30 * kSecondNs;
  }
  const RunResult failed = RunEstimator(SmallFilter(), log, {});
  ASSERT_TRUE(Failed(failed));
  const std::optional<std::string> cause = CauseOf(log, failed);
  ASSERT_TRUE(cause.has_value());
  EXPECT_THAT(*cause, HasSubstr("with all axes of the accelerometer negated"));
}

// GIVEN a failure that has nothing to do with signs THEN those given pass first and nothing else is tried.
TEST(FailureDiagnosisTest, SoundDataEndTheSearchAtTheFirstCombination) {
  const MeasurementLog log = LogWithSigns({1, 1, 1});
  RunResult failed;
  failed.status = Status::Diverged("never started");
  RunOptions options;
  std::vector<size_t> reported;
  options.progress = [&reported](size_t choice, size_t /*choices*/) { reported.push_back(choice); };
  EXPECT_FALSE(DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), failed, options).has_value());
  EXPECT_EQ(reported, std::vector<size_t>{1});
}

TEST(FailureDiagnosisTest, WhatIsUnderWayIsShownAndAStopEndsIt) {
  const MeasurementLog log = LogWithSigns({1, 1, -1});
  RunResult failed;
  failed.status = Status::Diverged("never started");
  std::atomic<bool> stop = false;
  RunOptions options;
  options.stop = &stop;
  std::vector<std::pair<size_t, size_t>> reported;
  options.progress = [&](size_t choice, size_t choices) {
    reported.emplace_back(choice, choices);
    stop = choice == 2;
  };
  EXPECT_FALSE(DiagnoseAccelerometerSigns(SmallFilter(), log, TablesOf(log), failed, options).has_value());
  const std::vector<std::pair<size_t, size_t>> expected = {{1, 8}, {2, 8}};
  EXPECT_EQ(reported, expected);
}

/// Trials in which all combinations start but that given, which holds or not; of the others the fourth alone
/// does.
SignTrials AllButThatGivenStart(bool as_given_holds, std::vector<size_t>* runs) {
  SignTrials trials;
  trials.starts = [](size_t choice) { return choice > 0; };
  trials.holds = [=](size_t choice) {
    runs->push_back(choice);
    const bool holds = choice == 0 ? as_given_holds : choice == 3;
    return holds ? std::optional(20.0) : std::nullopt;
  };
  trials.stopped = [] { return false; };
  return trials;
}

// GIVEN other signs with which the data start and run WHEN a run with the signs as given holds too THEN no
// sign is blamed, and no other is run.
TEST(FailureDiagnosisTest, SignsAreNotBlamedWhileARunWithThoseGivenHolds) {
  std::vector<size_t> runs;
  EXPECT_FALSE(SearchSigns(AllButThatGivenStart(true, &runs)).has_value());
  EXPECT_EQ(runs, std::vector<size_t>{0});
}

TEST(FailureDiagnosisTest, ARunWithTheSignsAsGivenComesFirst) {
  std::vector<size_t> runs;
  const std::optional<SignFinding> found = SearchSigns(AllButThatGivenStart(false, &runs));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->choice, 3u);
  EXPECT_EQ(found->held_s, 20);
  EXPECT_EQ(runs, (std::vector<size_t>{0, 1, 2, 3}));
}

// GIVEN an IMU that measures nonsense in the middle of a log WHEN the run is lost there THEN its signs are
// not blamed: it was sound before.
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
