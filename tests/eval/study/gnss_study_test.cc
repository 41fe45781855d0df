#include "eval/study/gnss_study.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "eval/simulation/simulator_config.h"
#include "eval/study/gnss_study_tables.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr TimeNs kStart = 1'000 * kSecondNs;
constexpr int kSteps = 600;  // of 0.1 s

/// A flight along x at 2 m/s.
Trajectory Truth() {
  Trajectory truth;
  for (int i = 0; i <= kSteps; ++i) {
    TrajectoryPoint& point = truth.points.emplace_back();
    point.stamp_ns = kStart + i * 100'000'000LL;
    point.nav.p_WB = Vector3d(0.2 * i, 0, 0);
    point.nav.v_WB = Vector3d(2, 0, 0);
  }
  return truth;
}

/// An estimate that is off by error_m(seconds) along y, with a deviation of 0.1 m an axis.
template <typename Error>
RunResult RunOff(const Trajectory& truth, const Error& error_m) {
  RunResult run;
  for (const TrajectoryPoint& point : truth.points) {
    RunRecord& record = run.records.emplace_back();
    record.estimate.stamp_ns = point.stamp_ns;
    record.estimate.nav = point.nav;
    record.estimate.nav.p_WB.y() += error_m(SecondsBetween(kStart, point.stamp_ns));
    record.estimate.covariance = 0.01 * Matrix15d::Identity();
  }
  return run;
}

GnssScenario Scenario() {
  SimulatorConfig config;
  config.rest_s = 2;
  config.gnss.rate_hz = 1;
  config.gnss.outage_start_s = 20;
  config.gnss.outage_s = 10;
  config.gnss.clock_jump_at_s = 45;
  config.fix.outage_start_s = 40;
  return ScenarioOf(config, 60);
}

/// 0.1 m; growing to 0.35 m in the outage, 0.2 m for 5 s after it; a step of 0.05 m and back at the jump.
double Error(double t) {
  if (t >= 20 && t < 30) {
    return 0.1 + 0.025 * (t - 20);
  }
  if (t >= 30 && t < 35) {
    return 0.2;
  }
  return t >= 45 && t < 45.15 ? 0.15 : 0.1;
}

TEST(GnssStudyTest, GivenNoReceiverThenTheOutageIsThatOfTheFixes) {
  SimulatorConfig config;
  config.fix.outage_start_s = 50;
  config.fix.outage_s = 30;
  config.gnss.outage_start_s = 20;
  const GnssScenario scenario = ScenarioOf(config, 60);
  EXPECT_EQ(scenario.outage_start_s, 50);
  EXPECT_EQ(scenario.outage_end_s, 60);
}

TEST(GnssStudyTest, ScoresAGlobalRunByItsErrorsAsTheyStand) {
  const Trajectory truth = Truth();
  RunResult run = RunOff(truth, Error);
  EXPECT_TRUE(std::isnan(ScoreGlobalRun(run, truth, kStart, Scenario()).rmse_m)) << "not aligned";
  run.global.emplace().stamp_ns = kStart + 3 * kSecondNs;
  const GnssRunFigures figures = ScoreGlobalRun(run, truth, kStart, Scenario());
  EXPECT_NEAR(figures.aligned_after_s, 1, 1e-9) << "motion starts after 2 s";
  EXPECT_NEAR(figures.early_m, std::sqrt((170 * 0.01 + 20 * 0.0128) / 190), 0.003);
  EXPECT_NEAR(figures.late_m, 0.1, 0.002);
  EXPECT_NEAR(figures.return_error_m, 0.1 + 0.025 * 9.9, 1e-9);
  EXPECT_EQ(figures.return_covered, 0) << "0.35 m at a deviation of 0.1 m";
  EXPECT_NEAR(figures.after_2_s_m, 0.2, 1e-9);
  EXPECT_NEAR(figures.jump_step_m, 0.05, 1e-9);
  double squares = 0;
  for (int i = 200; i < 300; ++i) {
    squares += Error(0.1 * i) * Error(0.1 * i);
  }
  EXPECT_NEAR(figures.outage_rmse_m, std::sqrt(squares / 100), 1e-6);
  EXPECT_NEAR(figures.nees_pos, 1 + (squares - 1 + 50 * 0.03 + 2 * 0.0125) / 0.01 / 571, 0.01);
}

TEST(GnssStudyTest, AnErrorWithinThreeDeviationsIsCovered) {
  const Trajectory truth = Truth();
  RunResult run = RunOff(truth, [](double) { return 0.29; });
  run.global.emplace().stamp_ns = kStart;
  const GnssRunFigures figures = ScoreGlobalRun(run, truth, kStart, Scenario());
  EXPECT_EQ(figures.return_covered, 1);
  EXPECT_EQ(figures.aligned_after_s, 0);
  EXPECT_NEAR(figures.rmse_m, 0.29, 1e-9);
}

// GIVEN an estimate in a world of its own, turned, shifted and drifting, THEN only the drift since the
// outage's start counts.
TEST(GnssStudyTest, OdometryIsEvaluatedFromTheStartOfTheOutage) {
  const Trajectory truth = Truth();
  RunResult run = RunOff(truth, [](double t) { return 0.01 * t; });
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Vector3d::UnitZ()).toRotationMatrix();
  for (RunRecord& record : run.records) {
    record.estimate.nav.R_WB = turn * record.estimate.nav.R_WB;
    record.estimate.nav.p_WB = turn * record.estimate.nav.p_WB + Vector3d(5, 6, 7);
  }
  const GnssRunFigures figures = ScoreOdometry(run, truth, kStart, Scenario());
  EXPECT_NEAR(figures.return_error_m, 0.01 * 9.9, 1e-9);
  EXPECT_TRUE(std::isnan(figures.rmse_m)) << "its world is its own";
  EXPECT_TRUE(std::isnan(ScoreOdometry(run, truth, kStart, GnssScenario()).return_error_m));
}

TEST(GnssStudyTest, SinglePointsOfANoiseFreeReceiverAreTheTruth) {
  SimulatorConfig sim;
  sim.start_time_s = 1'700'000'000;
  sim.duration_s = 5;
  sim.path_m = 10;
  sim.landmark_count = 10;
  sim.gnss.rate_hz = 1;
  sim.gnss.pseudorange_noise_m = 0;
  const auto rmse = [&] {
    const Dataset dataset = test::SimulateOrDie(sim, 1);
    const MeasurementLog log{dataset.rig, dataset.imu, dataset.frames, {}, dataset.gnss};
    return SinglePointRmse(GnssConfig(), log, *dataset.truth);
  };
  EXPECT_LT(rmse(), 0.01);
  sim.gnss.pseudorange_noise_m = 5;
  EXPECT_GT(rmse(), 1);
}

/// A row of `gvio` with outage errors by seed; VIO alone has 0.5 m.
GnssStudyRow OutageRow(const std::string& sequence,
                       const std::vector<std::pair<unsigned, double>>& errors_m) {
  GnssStudyRow row;
  row.sequence = sequence;
  row.estimator = "gvio";
  row.scenario = Scenario();
  for (const auto& [seed, error_m] : errors_m) {
    GnssStudyRun& run = row.runs.emplace_back();
    run.seed = seed;
    run.figures.outage_rmse_m = error_m;
    run.odometry.outage_rmse_m = 0.5;
  }
  return row;
}

TEST(GnssStudyTest, TablesHoldHowManyRunsCompleted) {
  GnssStudyRow row = OutageRow("outage", {{1, 0.25}, {2, GnssRunFigures::kNone}});
  GnssRunFigures& good = row.runs[0].figures;
  good.aligned_after_s = 1.5;
  good.rmse_m = 0.125;
  good.return_covered = 1;
  good.jump_step_m = 0.0625;
  row.runs[0].single_point_m = 0.75;
  row.runs[1].single_point_m = 1.25;
  const std::string tables = GnssStudyTables({row});
  EXPECT_NE(tables.find("| outage | `gvio` | 1 of 2 | 1.5, 1.5 | 0.125"), std::string::npos) << tables;
  EXPECT_NE(tables.find("| 1.00 | 1.00 |"), std::string::npos)
      << "ratio to itself, single points: " << tables;
  EXPECT_NE(tables.find("| 0.250 | 0.500 | 1 of 2 |"), std::string::npos) << tables;
  EXPECT_NE(tables.find("| – | – |"), std::string::npos) << "no satellite is left: " << tables;
  EXPECT_NE(tables.find("1 of 1"), std::string::npos) << "covered: " << tables;
  EXPECT_NE(tables.find("| outage | `gvio` | 0.062 | 0.062 |"), std::string::npos) << tables;
}

TEST(GnssStudyTest, AFewSatellitesAreComparedWithNoneByTheSameSeeds) {
  const GnssStudyRow none = OutageRow("no_satellite", {{2, 0.5}, {3, 0.5}});
  GnssStudyRow one = OutageRow("one_satellite", {{1, 0.01}, {2, 0.54}, {3, 0.56}});
  one.scenario.outage_satellites = 1;
  const std::string tables = GnssStudyTables({none, one});
  EXPECT_NE(tables.find("| one_satellite | `gvio` | 0.370 | 0.500 | 2 of 3 | 0.500 | 1 of 2 |"),
            std::string::npos)
      << tables;
  one.scenario.outage_end_s += 1;
  EXPECT_NE(GnssStudyTables({none, one}).find("| 2 of 3 | – | – |"), std::string::npos);
}

}  // namespace
}  // namespace alidade
