#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "eval/simulation/sim_trajectory.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

SimulatorConfig MotionConfig(SimTrajectory trajectory) {
  SimulatorConfig config;
  config.trajectory = trajectory;
  config.duration_s = 60;
  config.path_m = 60;
  return config;
}

SimulatorConfig HoverConfig() {
  SimulatorConfig config = MotionConfig(SimTrajectory::kHover);
  config.length_m = 0.6;
  config.width_m = 0.4;
  config.height_m = 0.2;
  config.path_m = 12;
  return config;
}

SimulatorConfig SpiralConfig() {
  SimulatorConfig config = MotionConfig(SimTrajectory::kSpiral);
  config.length_m = 4;
  config.spiral_widening_m = 0.5;
  config.spiral_climb_m = 1.5;
  return config;
}

/// A figure-8 that pauses for 6 s every 20 s, with a full turn about the camera.
SimulatorConfig PausingConfig() {
  SimulatorConfig config = MotionConfig(SimTrajectory::kFigureEight);
  config.rest_s = 1;
  config.rest_ramp_s = 1.5;
  config.pause_s = 6;
  config.pause_period_s = 20;
  config.pause_turn_rad = kTwoPi;
  config.path_point = SimPathPoint::kCamera;
  return config;
}

std::vector<SimulatorConfig> Motions() {
  std::vector<SimulatorConfig> motions = {HoverConfig(),
                                          MotionConfig(SimTrajectory::kRotation),
                                          MotionConfig(SimTrajectory::kLine),
                                          SpiralConfig(),
                                          PausingConfig(),
                                          MotionConfig(SimTrajectory::kRotation)};
  motions[0].yaw_rate_radps = 0.1;
  motions[2].speed_variation = 0.4;
  motions[2].speed_period_s = 7;
  motions[2].rest_s = 2;
  motions[5].path_point = SimPathPoint::kCamera;
  motions[5].camera_lever_arm_m << 0.3, -0.2, 0.5;
  motions[5].wobble_rad = 0.2;
  return motions;
}

// GIVEN a motion WHEN it is differentiated numerically THEN velocity, acceleration and angular rate are its
// derivatives: what the IMU feels is exact.
TEST(PathMotions, VelocityAccelerationAndRateAreTheDerivatives) {
  constexpr double kStep = 1e-4;
  for (const SimulatorConfig& config : Motions()) {
    const auto trajectory = MakeSimTrajectory(config, 4);
    // Of the figure-8 with pauses: resting, on each ramp, in a pause, in the next period.
    for (const double t : {0.5, 1.7, 12.0, 12.9, 15.0, 17.6, 20.3, 21.4, 33.3, 36.6, 47.7, 59.0}) {
      const Kinematics before = trajectory->At(t - kStep);
      const Kinematics at = trajectory->At(t);
      const Kinematics after = trajectory->At(t + kStep);
      const Eigen::Vector3d velocity = (after.nav.p_WB - before.nav.p_WB) / (2 * kStep);
      const Eigen::Vector3d acceleration = (after.nav.v_WB - before.nav.v_WB) / (2 * kStep);
      const Eigen::Vector3d rate = so3::Log(before.nav.R_WB.transpose() * after.nav.R_WB) / (2 * kStep);
      EXPECT_LT((velocity - at.nav.v_WB).norm(), 1e-6) << t;
      EXPECT_LT((acceleration - at.acceleration_W).norm(), 1e-6) << t;
      EXPECT_LT((rate - at.angular_rate_B).norm(), 1e-6) << t;
    }
  }
}

TEST(PathMotions, PathHasTheLengthAskedForAtEverySpeed) {
  for (SimulatorConfig config : Motions()) {
    if (config.trajectory == SimTrajectory::kRotation) {
      continue;
    }
    for (const double path_m : {6.0, config.trajectory == SimTrajectory::kHover ? 30.0 : 900.0}) {
      config.path_m = path_m;
      const auto trajectory = MakeSimTrajectory(config, 4);
      const Eigen::Vector3d p_B =
          config.path_point == SimPathPoint::kCamera ? config.camera_lever_arm_m : Eigen::Vector3d::Zero();
      constexpr double kStep = 2e-3;
      double travelled_m = 0;
      for (const double t : test::Steps(0.5 * kStep, config.duration_s, kStep)) {
        const Kinematics motion = trajectory->At(t);
        travelled_m += (motion.nav.v_WB + motion.nav.R_WB * motion.angular_rate_B.cross(p_B)).norm() * kStep;
      }
      EXPECT_NEAR(travelled_m / path_m, 1, 1e-4);
    }
  }
}

TEST(PathMotions, AccelerationIsSmoothThroughPauses) {
  const auto trajectory = MakeSimTrajectory(PausingConfig());
  constexpr double kStep = 1e-3;
  for (const double t : test::Steps(0, 45, kStep)) {
    const Kinematics here = trajectory->At(t);
    const Kinematics next = trajectory->At(t + kStep);
    ASSERT_LT((next.acceleration_W - here.acceleration_W).norm(), 20 * kStep) << t;
    ASSERT_LT((next.angular_rate_B - here.angular_rate_B).norm(), 20 * kStep) << t;
  }
}

TEST(PathMotions, GivenAHoverThenItStaysInItsBoxAndKeepsItsDirection) {
  SimulatorConfig config = HoverConfig();
  config.wobble_rad = 0;
  for (const double yaw_rate_radps : {0.0, 0.2}) {
    config.yaw_rate_radps = yaw_rate_radps;
    const auto trajectory = MakeSimTrajectory(config, 2);
    for (const double t : test::Steps(0, 60.05, 0.1)) {
      const NavState nav = trajectory->At(t).nav;
      ASSERT_TRUE((nav.p_WB.array().abs() <= Eigen::Array3d(0.3, 0.2, 0.2)).all()) << nav.p_WB.transpose();
      ASSERT_LT((nav.R_WB - so3::Exp({0, 0, yaw_rate_radps * t})).norm(), 1e-12);
    }
  }
  EXPECT_GT(
      (MakeSimTrajectory(config, 1)->At(20).nav.p_WB - MakeSimTrajectory(config, 2)->At(20).nav.p_WB).norm(),
      0.01)
      << "the seed decides";
}

// GIVEN a rotation about the body or about the camera THEN that point is fixed, the other moves on a sphere
// about it, and the yaw rate is the one asked for.
TEST(PathMotions, GivenARotationThenThePathPointIsFixed) {
  SimulatorConfig config = MotionConfig(SimTrajectory::kRotation);
  config.duration_s = 2000;
  config.rotation_rate_radps = 0.7;
  config.wobble_rad = 0;
  const auto about_body = MakeSimTrajectory(config, 3);
  config.path_point = SimPathPoint::kCamera;
  const auto about_camera = MakeSimTrajectory(config, 3);
  double squares = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const Kinematics body = about_body->At(0.1 * i);
    const Kinematics camera = about_camera->At(0.1 * i);
    ASSERT_EQ(body.nav.p_WB.norm(), 0);
    ASSERT_EQ(body.acceleration_W.norm(), 0);
    ASSERT_LT((camera.nav.T_WB() * config.camera_lever_arm_m).norm(), 1e-12);
    ASSERT_LT((body.nav.R_WB - camera.nav.R_WB).norm(), 1e-15);
    const double yaw_rate_radps = (body.nav.R_WB * body.angular_rate_B).z();
    squares += yaw_rate_radps * yaw_rate_radps / kCount;
  }
  EXPECT_NEAR(std::sqrt(squares), 0.7, 0.03);
}

TEST(PathMotions, GivenALineThenItIsStraightAndItsSpeedChangesByItsShare) {
  SimulatorConfig config = MotionConfig(SimTrajectory::kLine);
  config.path_m = 900;
  config.wobble_rad = 0;
  config.speed_variation = 0.3;
  const auto trajectory = MakeSimTrajectory(config);
  double slowest = 1e9, fastest = 0;
  for (const double t : test::Steps(0, 60.005, 0.01)) {
    const Kinematics motion = trajectory->At(t);
    ASSERT_EQ(motion.nav.p_WB.tail<2>().norm(), 0);
    ASSERT_LT((motion.nav.R_WB - Eigen::Matrix3d::Identity()).norm(), 1e-15);
    slowest = std::min(slowest, motion.nav.v_WB.x());
    fastest = std::max(fastest, motion.nav.v_WB.x());
  }
  EXPECT_NEAR(trajectory->At(60).nav.p_WB.x(), 900, 1e-3);
  EXPECT_NEAR(slowest, 0.7 * 15, 1e-2);
  EXPECT_NEAR(fastest, 1.3 * 15, 1e-2);
}

TEST(PathMotions, GivenASpiralThenItsRadiusAndHeightGrowAndTheBodyLooksAlongIt) {
  SimulatorConfig config = SpiralConfig();
  config.wobble_rad = 0;
  const auto trajectory = MakeSimTrajectory(config);
  for (const double t : test::Steps(0, 60.05, 0.1)) {
    const NavState nav = trajectory->At(t).nav;
    const double turns = nav.p_WB.z() / 1.5;
    ASSERT_NEAR(nav.p_WB.head<2>().norm(), 2 + 0.5 * turns, 1e-9) << t;
    ASSERT_LT((nav.R_WB.col(0) - nav.v_WB.normalized()).norm(), 1e-9) << t;
  }
  EXPECT_GT(trajectory->At(60).nav.p_WB.z(), 3) << "a few turns";
}

TEST(PathMotions, GivenAPauseThenTheCameraRestsAndTheBodyTurnsOnce) {
  const SimulatorConfig config = PausingConfig();
  const auto trajectory = MakeSimTrajectory(config);
  // Rest for 1 s, then 1.5 s of ramp, which count half: the period's clock is 1.75 s behind. It pauses from
  // 20 - 1.5 - 6 s on.
  const double first_s = 12.5 + 1.75;
  const Eigen::Vector3d p_WC = trajectory->At(first_s).nav.T_WB() * config.camera_lever_arm_m;
  double turned_rad = 0;
  constexpr double kStep = 1e-3;
  for (const double t : test::Steps(first_s, first_s + 6, kStep)) {
    const Kinematics motion = trajectory->At(t);
    ASSERT_LT((motion.nav.T_WB() * config.camera_lever_arm_m - p_WC).norm(), 1e-9) << t;
    turned_rad += (motion.nav.R_WB * motion.angular_rate_B).z() * kStep;
  }
  EXPECT_NEAR(turned_rad, kTwoPi, 1e-3);
  EXPECT_GT(trajectory->At(first_s - 1.5).nav.v_WB.norm(), 0.5);
  EXPECT_GT(trajectory->At(first_s + 7.5).nav.v_WB.norm(), 0.5);
}

TEST(PathMotions, GivenKeysThatContradictThenTheMessageNamesThem) {
  const auto message = [](const SimulatorConfig& config) { return config.Validate().message(); };
  SimulatorConfig pausing = PausingConfig();
  EXPECT_EQ(message(pausing), "");
  pausing.pause_period_s = 9;
  EXPECT_NE(message(pausing).find("pause_period_s: 9; expected more than pause_s"), std::string::npos)
      << message(pausing);
  SimulatorConfig hover = HoverConfig();
  hover.path_m = 2e4;
  EXPECT_NE(message(hover).find("path_m: 20000; expected less than 1e4 times length_m + width_m"),
            std::string::npos)
      << message(hover);
  SimulatorConfig spiral = SpiralConfig();
  spiral.path_m = 1e5;
  EXPECT_NE(message(spiral).find("path_m: 100000; expected less"), std::string::npos) << message(spiral);
  SimulatorConfig recorded;
  recorded.trajectory = SimTrajectory::kFile;
  recorded.trajectory_file = "flight.csv";
  recorded.path_point = SimPathPoint::kCamera;
  EXPECT_NE(message(recorded).find("path_point: camera; expected body"), std::string::npos)
      << message(recorded);
}

}  // namespace
}  // namespace alidade
