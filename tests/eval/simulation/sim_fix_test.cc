#include "eval/simulation/sim_fix.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "eval/dataset/dataset.h"
#include "eval/dataset/digest.h"
#include "eval/simulation/simulation.h"
#include "eval/simulation/simulator.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

SimulatorConfig Base() {
  SimulatorConfig config;
  config.duration_s = 60;
  config.path_m = 60;
  config.max_features = 1;
  config.landmark_count = 10;
  config.fix.rate_hz = 5;
  return config;
}

Simulation Make(const SimulatorConfig& config, unsigned seed = 1) {
  Result<Simulation> simulation = SimulateWithMotion(config, seed);
  EXPECT_TRUE(simulation.ok()) << simulation.message();
  return *std::move(simulation);
}

/// Measured less true position of the measured point, in the world.
std::vector<Vector3d> Errors(const SimulatorConfig& config, const Simulation& simulation) {
  std::vector<Vector3d> errors;
  for (const PositionFix& fix : simulation.dataset.fixes) {
    const double time_s = SecondsBetween(simulation.motion_start_ns, fix.stamp_ns) +
                          simulation.dataset.rig.fixes[0].time_offset_s;
    const NavState nav = simulation.motion->At(time_s).nav;
    const Eigen::Matrix3d R_WF =
        Eigen::AngleAxisd(-config.fix.frame_yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
    errors.push_back(R_WF * (fix.p_A - config.fix.frame_shift_m) - nav.p_WB -
                     nav.R_WB * config.fix.lever_arm_m);
  }
  return errors;
}

TEST(SimFix, GIVEN_no_rate_THEN_there_is_no_sensor_and_all_else_is_the_same) {
  SimulatorConfig without = Base();
  without.fix.rate_hz = 0;
  const Dataset with = Make(Base()).dataset;
  const Dataset none = Make(without).dataset;
  EXPECT_TRUE(none.fixes.empty() && none.rig.fixes.empty());
  EXPECT_EQ(DigestOf(MeasurementLog{none.rig, none.imu, none.frames}),
            DigestOf(MeasurementLog{with.rig, with.imu, with.frames}));
}

TEST(SimFix, GIVEN_a_frame_of_its_own_and_an_offset_THEN_errors_have_the_written_covariance) {
  SimulatorConfig config = Base();
  config.fix.rate_hz = 20;
  config.fix.std_m = 0.5;
  config.fix.time_offset_s = 0.033;
  config.fix.own_frame = true;
  config.fix.frame_yaw_rad = 2;
  config.fix.frame_shift_m = Vector3d(100, -50, 7);
  const Simulation simulation = Make(config);
  EXPECT_FALSE(simulation.dataset.rig.fixes[0].anchor_llh_deg);
  double sum = 0;
  const std::vector<Vector3d> errors = Errors(config, simulation);
  EXPECT_NEAR(static_cast<double>(errors.size()), 1200, 2);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    sum += errors[i].cwiseAbs2().dot(simulation.dataset.fixes[i].covariance.diagonal().cwiseInverse()) / 3;
  }
  const auto count = static_cast<double>(errors.size());
  EXPECT_NEAR(sum / count, 1, 4 * std::sqrt(2 / (3 * count)));
}

TEST(SimFix, GIVEN_wrong_fixes_and_an_outage_THEN_the_others_keep_their_numbers) {
  SimulatorConfig config = Base();
  const Simulation clean = Make(config);
  EXPECT_EQ(*clean.dataset.rig.fixes[0].anchor_llh_deg, Vector3d(47.4, 8.5, 450));
  config.fix.wrong_rate = 0.1;
  config.fix.outage_start_s = 20;
  config.fix.outage_s = 10;
  const Simulation faulty = Make(config);
  EXPECT_NEAR(static_cast<double>(faulty.dataset.fixes.size()), 250, 2);
  std::size_t next = 0;
  int wrong = 0;
  for (const PositionFix& fix : faulty.dataset.fixes) {
    const double time_s = SecondsBetween(faulty.motion_start_ns, fix.stamp_ns);
    EXPECT_FALSE(time_s >= 20 && time_s < 30);
    while (clean.dataset.fixes[next].stamp_ns < fix.stamp_ns) {
      ++next;
    }
    const double distance = (fix.p_A - clean.dataset.fixes[next].p_A).norm();
    if (distance > 0) {
      ++wrong;
      EXPECT_GE(distance, 10 - 1e-9);
      EXPECT_LE(distance, 50 + 1e-9);
    }
  }
  EXPECT_GT(wrong, 10);
  EXPECT_LT(wrong, 45);
}

TEST(SimFix, GIVEN_the_same_seed_THEN_the_same_fixes_and_another_one_others) {
  const Dataset first = Make(Base(), 3).dataset;
  const Dataset again = Make(Base(), 3).dataset;
  const Dataset other = Make(Base(), 4).dataset;
  EXPECT_EQ(first.fixes[7].p_A, again.fixes[7].p_A);
  EXPECT_NE(first.fixes[7].p_A, other.fixes[7].p_A);
}

TEST(SimFix, GIVEN_a_turn_of_the_world_frame_THEN_the_configuration_is_refused) {
  SimulatorConfig config = Base();
  config.fix.frame_yaw_rad = 1;
  EXPECT_EQ(config.Validate().code(), StatusCode::kConfig);
  config.fix.own_frame = true;
  EXPECT_TRUE(config.Validate().ok());
  config.fix.wrong_min_m = 60;
  EXPECT_EQ(config.Validate().code(), StatusCode::kConfig);
}

}  // namespace
}  // namespace alidade
