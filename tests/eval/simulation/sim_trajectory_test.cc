#include "eval/simulation/sim_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/steps.h"

namespace alidade {
namespace {

std::vector<SimulatorConfig> Variants() {
  std::vector<SimulatorConfig> variants(5);
  variants[1].trajectory = SimTrajectory::kEllipse;
  variants[2].rest_s = 5;
  variants[3].trajectory = SimTrajectory::kEllipse;
  variants[3].rest_s = 3;
  variants[3].wobble_rad = 0.3;
  variants[4].trajectory = SimTrajectory::kWander;
  variants[4].rest_s = 2;
  return variants;
}

TEST(SimTrajectoryTest, VelocityAccelerationAndRateAreTheDerivatives) {
  constexpr double kStep = 1e-4;
  for (const SimulatorConfig& config : Variants()) {
    const auto trajectory = MakeSimTrajectory(config);
    // 5.3 s, 6.1 s and 4.2 s lie on the ramps.
    for (const double t : {0.5, 4.2, 5.3, 6.1, 12.0, 33.3, 77.7, 150.0, 199.0}) {
      const Kinematics before = trajectory->At(t - kStep);
      const Kinematics at = trajectory->At(t);
      const Kinematics after = trajectory->At(t + kStep);
      const Eigen::Vector3d velocity = (after.nav.p_WB - before.nav.p_WB) / (2 * kStep);
      const Eigen::Vector3d acceleration = (after.nav.v_WB - before.nav.v_WB) / (2 * kStep);
      const Eigen::Vector3d rate = so3::Log(before.nav.R_WB.transpose() * after.nav.R_WB) / (2 * kStep);
      EXPECT_LT((velocity - at.nav.v_WB).norm(), 1e-7) << t;
      EXPECT_LT((acceleration - at.acceleration_W).norm(), 1e-7) << t;
      EXPECT_LT((rate - at.angular_rate_B).norm(), 1e-7) << t;
    }
  }
}

TEST(SimTrajectoryTest, PathHasTheLengthAskedFor) {
  for (const SimulatorConfig& config : Variants()) {
    const auto trajectory = MakeSimTrajectory(config);
    constexpr double kStep = 1e-3;
    double path_m = 0;
    for (const double t : test::Steps(0.5 * kStep, config.duration_s, kStep)) {
      path_m += trajectory->At(t).nav.v_WB.norm() * kStep;
    }
    EXPECT_NEAR(path_m, 262, config.trajectory == SimTrajectory::kWander ? 2e-3 : 1e-4);
  }
}

TEST(SimTrajectoryTest, FigureEightFillsItsBox) {
  const SimulatorConfig config;
  const auto trajectory = MakeSimTrajectory(config);
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9);
  Eigen::Vector3d high = -low;
  for (const double t : test::Steps(0, 60, 0.01)) {
    low = low.cwiseMin(trajectory->At(t).nav.p_WB);
    high = high.cwiseMax(trajectory->At(t).nav.p_WB);
  }
  EXPECT_LT((high - Eigen::Vector3d(5, 2.5, 0.5)).norm(), 1e-3);
  EXPECT_LT((low + Eigen::Vector3d(5, 2.5, 0.5)).norm(), 1e-3);
}

TEST(SimTrajectoryTest, BodyLooksAlongTheMotion) {
  SimulatorConfig config;
  config.wobble_rad = 0;
  const auto trajectory = MakeSimTrajectory(config);
  for (const double t : test::Steps(0, 60, 0.7)) {
    const Kinematics motion = trajectory->At(t);
    EXPECT_LT((motion.nav.R_WB.col(0) - motion.nav.v_WB.normalized()).norm(), 1e-12);
    EXPECT_NEAR(motion.nav.R_WB(2, 1), 0, 1e-12) << "no roll without wobble";
  }
}

TEST(SimTrajectoryTest, RestIsRest) {
  SimulatorConfig config;
  config.rest_s = 5;
  const auto trajectory = MakeSimTrajectory(config);
  const Kinematics start = trajectory->At(0);
  for (const double t : {0.0, 2.5, 5.0}) {
    const Kinematics motion = trajectory->At(t);
    EXPECT_EQ(motion.nav.v_WB.norm(), 0);
    EXPECT_EQ(motion.angular_rate_B.norm(), 0);
    EXPECT_EQ(motion.acceleration_W.norm(), 0);
    EXPECT_EQ((motion.nav.p_WB - start.nav.p_WB).norm(), 0);
    EXPECT_NEAR(motion.SpecificForce(9.81).norm(), 9.81, 1e-12);
  }
  EXPECT_GT(trajectory->At(8).nav.v_WB.norm(), 1);
}

TEST(SimTrajectoryTest, AccelerationIsSmoothThroughTheRamp) {
  SimulatorConfig config;
  config.rest_s = 5;
  const auto trajectory = MakeSimTrajectory(config);
  // A jump of the third difference by O(1) would mean a kink; the ramp's own jerk is bounded by about 10
  // m/s^3.
  constexpr double kStep = 1e-3;
  for (const double t : test::Steps(4.9, 7.2, kStep)) {
    const Eigen::Vector3d change =
        trajectory->At(t + kStep).acceleration_W - trajectory->At(t).acceleration_W;
    ASSERT_LT(change.norm(), 10 * kStep) << t;
  }
}

TEST(SimTrajectoryTest, EveryAxisIsExcited) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  Eigen::Vector3d rate2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration2 = Eigen::Vector3d::Zero();
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) {
    const Kinematics motion = trajectory->At(i * 0.1);
    rate2 += motion.angular_rate_B.cwiseAbs2() / kCount;
    acceleration2 += motion.acceleration_W.cwiseAbs2() / kCount;
  }
  EXPECT_GT(rate2.cwiseSqrt().minCoeff(), 0.05);
  EXPECT_GT(acceleration2.cwiseSqrt().minCoeff(), 0.1);
}

}  // namespace
}  // namespace alidade
