#include <gtest/gtest.h>

#include <cmath>

#include "eval/simulation/sim_trajectory.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

SimulatorConfig WanderConfig() {
  SimulatorConfig config;
  config.trajectory = SimTrajectory::kWander;
  config.duration_s = 1000;
  config.path_m = 1300;
  return config;
}

TEST(WanderTest, StaysInItsBoxAndFillsIt) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const auto trajectory = MakeSimTrajectory(WanderConfig(), seed);
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9);
    Eigen::Vector3d high = -low;
    for (const double t : test::Steps(0, 1000.05, 0.1)) {
      const Eigen::Vector3d p_WB = trajectory->At(t).nav.p_WB;
      low = low.cwiseMin(p_WB);
      high = high.cwiseMax(p_WB);
    }
    const Eigen::Vector3d bound(5, 2.5, 0.5);
    EXPECT_TRUE((high.array() <= bound.array()).all()) << high.transpose();
    EXPECT_TRUE((low.array() >= -bound.array()).all()) << low.transpose();
    EXPECT_TRUE(((high - low).array() > 1.6 * bound.array()).all()) << (high - low).transpose();
  }
}

TEST(WanderTest, IsSmooth) {
  const auto trajectory = MakeSimTrajectory(WanderConfig(), 1);
  constexpr double kStep = 0.01;
  Kinematics last = trajectory->At(0);
  for (const double t : test::Steps(kStep, 1000, kStep)) {
    const Kinematics here = trajectory->At(t);
    ASSERT_LT(here.nav.v_WB.norm(), 6) << t;
    ASSERT_LT(here.angular_rate_B.norm(), 4) << t;
    ASSERT_LT((here.acceleration_W - last.acceleration_W).norm(), 10 * kStep) << t;
    ASSERT_LT((here.angular_rate_B - last.angular_rate_B).norm(), 10 * kStep) << t;
    last = here;
  }
}

TEST(WanderTest, NeverComesBackToTheSameStateWithinTheRun) {
  const auto trajectory = MakeSimTrajectory(WanderConfig(), 1);
  const NavState start = trajectory->At(0).nav;
  for (const double t : test::Steps(5, 1000, 0.05)) {
    const NavState here = trajectory->At(t).nav;
    const double difference = (here.p_WB - start.p_WB).norm() + (here.v_WB - start.v_WB).norm() +
                              so3::Log(start.R_WB.transpose() * here.R_WB).norm();
    ASSERT_GT(difference, 0.1) << t;
  }
}

TEST(WanderTest, TheSeedDecidesThePathOfWanderAlone) {
  const auto first = MakeSimTrajectory(WanderConfig(), 1);
  EXPECT_EQ(first->At(33).nav.p_WB, MakeSimTrajectory(WanderConfig(), 1)->At(33).nav.p_WB);
  EXPECT_GT((first->At(33).nav.p_WB - MakeSimTrajectory(WanderConfig(), 2)->At(33).nav.p_WB).norm(), 0.1);
  EXPECT_EQ(MakeSimTrajectory(SimulatorConfig(), 1)->At(33).nav.p_WB,
            MakeSimTrajectory(SimulatorConfig(), 2)->At(33).nav.p_WB);
}

}  // namespace
}  // namespace alidade
