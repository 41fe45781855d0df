#include "eval/run/health_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/estimator/estimator.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using testing::HasSubstr;

NavEstimate Sound(TimeNs stamp_ns) {
  NavEstimate estimate;
  estimate.stamp_ns = stamp_ns;
  estimate.nav.v_WB << 1, 2, 0;
  estimate.covariance = 1e-4 * Matrix15d::Identity();
  return estimate;
}

TEST(HealthMonitorTest, NamesWhatIsWrongWithFigureAndLimit) {
  HealthMonitor monitor{RecoveryConfig()};
  EXPECT_EQ(monitor.Check(Sound(0), {}), "");
  NavEstimate fast = Sound(0);
  fast.nav.v_WB.x() = 150;
  EXPECT_THAT(monitor.Check(fast, {}), HasSubstr("speed 150 m/s, limit 100"));
  NavEstimate biased = Sound(0);
  biased.bias.gyro.y() = -2;
  EXPECT_THAT(monitor.Check(biased, {}), HasSubstr("gyroscope bias"));
  biased = Sound(0);
  biased.bias.accel.z() = 9;
  EXPECT_THAT(monitor.Check(biased, {}), HasSubstr("accelerometer bias"));
  NavEstimate broken = Sound(0);
  broken.nav.p_WB.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(monitor.Check(broken, {}), HasSubstr("not finite"));
  broken = Sound(0);
  broken.covariance(3, 3) = -1;
  EXPECT_THAT(monitor.Check(broken, {}), HasSubstr("negative variance"));
}

TEST(HealthMonitorTest, SuspicionMustLast) {
  RecoveryConfig config;
  config.max_suspect_s = 1;
  HealthMonitor monitor(config);
  FrameStatistics suspect;
  suspect.suspect = true;
  suspect.features_used = 40;
  FrameStatistics good;
  good.features_used = 40;
  FrameStatistics nothing;
  FrameStatistics none_fits;
  none_fits.features_degenerate = 3;
  FrameStatistics resting = none_fits;
  resting.at_rest = true;
  EXPECT_EQ(monitor.Check(Sound(0), suspect), "");
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(0.9)), suspect), "");
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(1.0)), good), "") << "a frame that most tracks support clears it";
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(1.1)), suspect), "");
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(1.6)), nothing), "") << "a frame without tracks says nothing";
  EXPECT_THAT(monitor.Check(Sound(SecondsToNs(2.2)), suspect), HasSubstr("contradict"));
  monitor.Reset();
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(2.3)), suspect), "");
  monitor.Reset();
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(3)), none_fits), "");
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(3.5)), resting), "") << "rest needs no tracks";
  EXPECT_EQ(monitor.Check(Sound(SecondsToNs(4)), none_fits), "");
  EXPECT_THAT(monitor.Check(Sound(SecondsToNs(5.5)), none_fits), HasSubstr("contradict"));
}

TEST(ContinueFromTest, TakesYawAndPositionFromTheReckoningAndTheRestFromTheStart) {
  test::RandomStates random(71);
  NavEstimate reckoned = Sound(SecondsToNs(3));
  reckoned.nav = random.Nav(4);
  // The same motion in a world of its own, turned and shifted.
  const Eigen::Matrix3d turn = so3::Exp(Eigen::Vector3d(0, 0, 1.3));
  NavEstimate start = reckoned;
  start.nav = {turn * reckoned.nav.R_WB, Eigen::Vector3d::Zero(), turn * reckoned.nav.v_WB};
  start.bias.accel << 0.1, 0.2, 0.3;
  const NavEstimate moved = ContinueFrom(Sound(0), reckoned, start);
  EXPECT_LT((moved.nav.R_WB - reckoned.nav.R_WB).norm(), 1e-12);
  EXPECT_LT((moved.nav.p_WB - reckoned.nav.p_WB).norm(), 1e-12);
  EXPECT_LT((moved.nav.v_WB - reckoned.nav.v_WB).norm(), 1e-12);
  EXPECT_EQ(moved.bias.accel, start.bias.accel);
  EXPECT_TRUE(CheckInitialState(moved).ok());
  EXPECT_LT(moved.covariance.diagonal().maxCoeff(), 1e-2) << "both agree: nothing is added";
}

TEST(ContinueFromTest, DisagreementIsUncertaintyAndAFailedReckoningIsDropped) {
  NavEstimate sound = Sound(0);
  sound.nav.p_WB << 1, 1, 1;
  NavEstimate start = Sound(SecondsToNs(2));
  NavEstimate reckoned = start;
  reckoned.nav.p_WB << 5, 5, 5;
  reckoned.nav.v_WB.x() += 0.5;
  const NavEstimate slipped = ContinueFrom(sound, reckoned, start);
  EXPECT_EQ(slipped.nav.p_WB, reckoned.nav.p_WB);
  EXPECT_NEAR(slipped.covariance(3, 3), 1, 0.01);  // (0.5 m/s times 2 s) squared
  reckoned.nav.v_WB.x() += 40;
  const NavEstimate held = ContinueFrom(sound, reckoned, start);
  EXPECT_EQ(held.nav.p_WB, sound.nav.p_WB);
  EXPECT_GT(held.covariance(3, 3), 10);
  EXPECT_GT(held.covariance(2, 2), 0.9);
}

// The turn between two worlds does not depend on how the body stands: here with its x axis near the vertical,
// rolled, and with a tilt that differs by little.
TEST(ContinueFromTest, TheYawIsRightWhereTheBodysAxisIsUpright) {
  NavEstimate reckoned = Sound(SecondsToNs(3));
  reckoned.nav.R_WB = so3::Exp(Eigen::Vector3d(0, -1.1206, 0)) * so3::Exp(Eigen::Vector3d(0.35, 0, 0));
  NavEstimate start = reckoned;
  start.nav.R_WB = so3::Exp(Eigen::Vector3d(0, -1.1186, 0)) * so3::Exp(Eigen::Vector3d(0.35, 0, 0));
  ASSERT_GT(std::abs(reckoned.nav.R_WB(2, 0)), 0.9);
  ASSERT_LT(std::abs(start.nav.R_WB(2, 0)), 0.9);
  const NavEstimate moved = ContinueFrom(Sound(0), reckoned, start);
  EXPECT_LT(so3::Log(moved.nav.R_WB.transpose() * reckoned.nav.R_WB).norm(), 0.004);
}

}  // namespace
}  // namespace alidade
