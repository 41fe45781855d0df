#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "eval/config/config_yaml.h"
#include "eval/metrics/nees.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "eval/trajectory/trajectory_point.h"

namespace alidade {
namespace {

constexpr double kFaultS = 8;

struct Faulty {
  Dataset dataset;
  RunResult result;
  double rmse_m = 0;

  [[nodiscard]] TimeNs fault_ns() const {
    return dataset.truth->points.front().stamp_ns + SecondsToNs(kFaultS);
  }
  /// Of the records of this status.
  [[nodiscard]] std::vector<double> SecondsAfterTheFault(const std::string& status) const {
    std::vector<double> seconds;
    for (const RunRecord& record : result.records) {
      if (record.status == status) {
        seconds.push_back(SecondsBetween(fault_ns(), record.estimate.stamp_ns));
      }
    }
    return seconds;
  }
};

/// Runs of both back ends through the faults of a sensor, each beside the clean run.
class FaultRunTest : public testing::TestWithParam<Backend> {
 protected:
  static Faulty Run(SimFaultKind fault, double duration_s) {
    SimulatorConfig simulation;
    simulation.duration_s = 20;
    simulation.path_m = 1.31 * simulation.duration_s;
    simulation.wobble_rad = 0.15;
    simulation.fault = fault;
    simulation.fault_start_s = kFaultS;
    simulation.fault_duration_s = duration_s;
    Faulty run;
    Result<Dataset> dataset = Simulate(simulation, 105);
    EXPECT_TRUE(dataset.ok()) << dataset.message();
    run.dataset = std::move(*dataset);
    EstimatorConfig config;
    config.backend = GetParam();
    config.init.method = InitMethod::kTruth;
    run.result = RunEstimator(config, {run.dataset.rig, run.dataset.imu, run.dataset.frames},
                              &*run.dataset.truth, 105);
    EXPECT_TRUE(run.result.status.ok()) << run.result.status.message();
    for (const RunRecord& record : run.result.records) {
      const Result<TrajectoryPoint> truth = InterpolateTruth(*run.dataset.truth, record.estimate.stamp_ns);
      run.rmse_m += (truth->nav.p_WB - record.estimate.nav.p_WB).squaredNorm();
    }
    run.rmse_m = std::sqrt(run.rmse_m / static_cast<double>(run.result.records.size()));
    return run;
  }
};

TEST_P(FaultRunTest, OneWildSampleIsMendedReportedAndWithoutEffect) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  EXPECT_EQ(clean.result.imu_rejected, 0);
  EXPECT_EQ(clean.SecondsAfterTheFault("ok").size(), clean.result.records.size());
  for (const SimFaultKind fault : {SimFaultKind::kGyroSpike, SimFaultKind::kAccelSpike}) {
    const Faulty run = Run(fault, 1);
    EXPECT_EQ(run.result.imu_rejected, 1);
    EXPECT_EQ(run.SecondsAfterTheFault("ok").size(), run.result.records.size());
    EXPECT_LT(run.rmse_m, 1.2 * clean.rmse_m + 0.003);
  }
}

/// The run went on, was degraded from 0.3 s after the fault began at the latest (frames come at 10 Hz), and
/// no longer than until `last_s`.
void ExpectReportedAtOnce(const Faulty& run, double last_s) {
  EXPECT_TRUE(run.result.restarts.empty());
  const std::vector<double> degraded = run.SecondsAfterTheFault("degraded");
  ASSERT_FALSE(degraded.empty());
  EXPECT_LE(degraded.front(), 0.31);
  EXPECT_LT(degraded.back(), last_s);
}

TEST_P(FaultRunTest, ASilentImuIsReportedAndCovered) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  const Faulty run = Run(SimFaultKind::kImuGap, 0.2);
  ExpectReportedAtOnce(run, 1.5);
  EXPECT_LT(run.rmse_m, 1.5 * clean.rmse_m + 0.01);
}

// GIVEN an axis that repeats its last value, THEN it is reported while it lasts, and the estimate goes on.
TEST_P(FaultRunTest, AStuckAxisIsReportedWhileItLasts) {
  for (const SimFaultKind fault : {SimFaultKind::kGyroStuck, SimFaultKind::kAccelStuck}) {
    const Faulty run = Run(fault, 3);
    ExpectReportedAtOnce(run, 3.6);
    EXPECT_EQ(run.result.imu_rejected, 1);
    EXPECT_GT(run.SecondsAfterTheFault("degraded").back(), 2.9);
  }
}

SimulatorConfig FaultyMotion(SimFaultKind fault, double start_s, double duration_s) {
  SimulatorConfig simulation;
  simulation.duration_s = 60;
  simulation.path_m = 78;
  simulation.imu_rate_hz = 100;
  simulation.camera_rate_hz = 10;
  simulation.fault = fault;
  simulation.fault_start_s = start_s;
  simulation.fault_duration_s = duration_s;
  return simulation;
}

// Pose NEES over such a motion.
double NeesWithFaultyAxes(EstimatorConfig config, const SimulatorConfig& simulation, std::uint64_t seed) {
  const Result<Dataset> dataset = Simulate(simulation, seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  config.init.method = InitMethod::kTruth;
  const RunResult run =
      RunEstimator(config, {dataset->rig, dataset->imu, dataset->frames}, &*dataset->truth, seed);
  EXPECT_TRUE(run.status.ok()) << run.status.message();
  std::vector<StatePair> pairs;
  for (const RunRecord& record : run.records) {
    const Result<TrajectoryPoint> truth = InterpolateTruth(*dataset->truth, record.estimate.stamp_ns);
    EXPECT_TRUE(truth.ok()) << truth.message();
    pairs.push_back({*truth, PointOf(record.estimate)});
  }
  return ComputeNees(pairs).mean_pose;
}

EstimatorConfig AlidadeFilter() {
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/alidade_filter.yaml", {});
  EXPECT_TRUE(config.ok()) << config.message();
  return config.ok() ? *config : EstimatorConfig();
}

// GIVEN a gyroscope axis that sticks for ten seconds while the body turns about it, THEN the covariance still
// holds: a correction of the attitude by some degrees in every frame would deform the estimate.
TEST(FaultyAxes, AStuckGyroscopeLeavesTheCovarianceTrue) {
  for (const std::uint64_t seed : {915u, 919u}) {
    EXPECT_LT(NeesWithFaultyAxes({}, FaultyMotion(SimFaultKind::kGyroStuck, 20, 10), seed), 15) << seed;
  }
}

// GIVEN an accelerometer whose axes are clipped throughout, so that the scale is known to some percent, THEN
// the covariance of the preset that carries the direction of the scale holds.
TEST(FaultyAxes, ASaturatedAccelerometerLeavesTheCovarianceTrue) {
  for (const std::uint64_t seed : {941u, 945u}) {
    EXPECT_LT(NeesWithFaultyAxes(AlidadeFilter(), FaultyMotion(SimFaultKind::kAccelSaturation, 0, 60), seed),
              15)
        << seed;
  }
}

// GIVEN a gyroscope whose axes are clipped, and in a turn are so from the first sample on, or from some
// second on below what they measured before, THEN the covariance holds.
TEST(FaultyAxes, AGyroscopeThatIsClippedInATurnLeavesTheCovarianceTrue) {
  for (const double start_s : {0.0, 8.0}) {
    SimulatorConfig simulation = FaultyMotion(SimFaultKind::kGyroSaturation, start_s, 60);
    simulation.trajectory = SimTrajectory::kEllipse;
    simulation.duration_s = 40;
    simulation.path_m = 60;
    for (const std::uint64_t seed : {921u, 923u}) {
      EXPECT_LT(NeesWithFaultyAxes(AlidadeFilter(), simulation, seed), 15) << start_s << " s, seed " << seed;
    }
  }
}

// GIVEN an IMU that is silent, or repeats itself, for two seconds of a turn, THEN the covariance of the
// motion that the tracks alone determine holds.
TEST(FaultyAxes, TwoSecondsWithTracksAloneLeaveTheCovarianceTrue) {
  for (const SimFaultKind fault : {SimFaultKind::kImuGap, SimFaultKind::kImuFrozen}) {
    SimulatorConfig simulation = FaultyMotion(fault, 15, 2);
    simulation.duration_s = 40;
    simulation.path_m = 52;
    for (const std::uint64_t seed : {974u, 975u, 976u, 979u}) {
      EXPECT_LT(NeesWithFaultyAxes(AlidadeFilter(), simulation, seed), 15) << seed;
    }
  }
}

// GIVEN an IMU, or a gyroscope, all of whose axes repeat themselves, THEN it is reported while it lasts, and
// covered.
TEST_P(FaultRunTest, AFrozenImuIsReportedAndCovered) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  for (const SimFaultKind fault : {SimFaultKind::kGyroFrozen, SimFaultKind::kImuFrozen}) {
    const Faulty run = Run(fault, 1);
    ExpectReportedAtOnce(run, 1.6);
    EXPECT_EQ(run.result.imu_rejected, 1);
    EXPECT_LT(run.rmse_m, 2 * clean.rmse_m + 0.02);
  }
}

TEST_P(FaultRunTest, AGyroscopeThatChangesToDegreesIsConvertedAndReported) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  const Faulty run = Run(SimFaultKind::kImuUnit, 3);
  ExpectReportedAtOnce(run, 1);
  EXPECT_EQ(run.result.imu_rejected, 1);
  EXPECT_LT(run.rmse_m, 1.1 * clean.rmse_m + 0.003);
}

TEST_P(FaultRunTest, ImagesThatRepeatThemselvesAreNotUsedAndReportedAtOnce) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  const Faulty run = Run(SimFaultKind::kFrozen, 2);
  ExpectReportedAtOnce(run, 2.2);
  EXPECT_LT(run.rmse_m, 1.5 * clean.rmse_m + 0.02);
}

TEST_P(FaultRunTest, ABlackoutIsReportedAtOnce) {
  ExpectReportedAtOnce(Run(SimFaultKind::kBlackout, 2), 2.2);
}

// GIVEN a camera whose clock jumps, THEN the jump is reported and taken off its stamps, and no frame is lost.
TEST_P(FaultRunTest, AJumpOfTheCamerasClockIsTakenOffItsStamps) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  const Faulty run = Run(SimFaultKind::kCameraClock, 1);
  ExpectReportedAtOnce(run, 1);
  EXPECT_EQ(run.result.records.size(), clean.result.records.size());
  EXPECT_LT(run.rmse_m, 1.2 * clean.rmse_m + 0.003);
}

// GIVEN an IMU whose clock jumps, THEN likewise.
TEST_P(FaultRunTest, AJumpOfTheImusClockIsTakenOffItsStamps) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  const Faulty run = Run(SimFaultKind::kImuClock, 1);
  ExpectReportedAtOnce(run, 1);
  EXPECT_EQ(run.result.records.size(), clean.result.records.size());
  EXPECT_EQ(run.rmse_m, clean.rmse_m);
}

TEST_P(FaultRunTest, MissingFramesCostLittle) {
  const Faulty clean = Run(SimFaultKind::kNone, 0);
  const Faulty run = Run(SimFaultKind::kFrameDrops, 1000);
  EXPECT_LT(run.result.records.size(), clean.result.records.size());
  EXPECT_EQ(run.SecondsAfterTheFault("ok").size(), run.result.records.size());
  EXPECT_LT(run.rmse_m, 1.3 * clean.rmse_m + 0.01);
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, FaultRunTest, testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& of) { return of.param == Backend::kFilter ? "filter" : "smoother"; });

}  // namespace
}  // namespace alidade
