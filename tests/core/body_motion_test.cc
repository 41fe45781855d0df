#include "core/body_motion.h"

#include <gtest/gtest.h>

#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using test::RandomStates;

std::vector<ImuSample> Ramp(double rate_hz, int count) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < count; ++k) {
    const double t_s = k / rate_hz;
    samples.push_back({SecondsToNs(t_s), Vector3d(0.1 + 2 * t_s, -0.5 * t_s, 0.3), Vector3d::Zero()});
  }
  return samples;
}

TEST(BodyMotionTest, TheChangeOfTheRateIsThatOverTenMilliseconds) {
  for (const double rate_hz : {50.0, 100.0, 1000.0}) {
    const std::vector<ImuSample> samples = Ramp(rate_hz, 30);
    const MeasuredTurn turn = TurnAtEnd(samples);
    EXPECT_EQ(turn.gyro_radps, samples.back().gyro);
    EXPECT_LT((turn.alpha_radps2 - Vector3d(2, -0.5, 0)).norm(), 1e-6) << rate_hz;
  }
  // One sample off by 0.01 rad/s: of the last step at 1 kHz alone that would be 10 rad/s^2.
  std::vector<ImuSample> noisy = Ramp(1000, 30);
  noisy[noisy.size() - 2].gyro.x() += 0.01;
  EXPECT_LT((TurnAtEnd(noisy).alpha_radps2 - Vector3d(2, -0.5, 0)).norm(), 1e-6);
  EXPECT_EQ(TurnAtEnd(std::span(noisy).first(1)).alpha_radps2, Vector3d::Zero());
}

TEST(BodyMotionTest, TheRatesAreThoseOfThePose) {
  RandomStates random(31);
  for (int trial = 0; trial < 20; ++trial) {
    const BodyMotion motion{random.Vector(3), random.Vector(20), random.Vector(4)};
    const Pose T_WB = random.RandomPose(2);
    const double at_s = random.Uniform(-0.02, 0.02);
    const Pose then = T_WB * motion.After(at_s);
    const auto moved = [&](const VectorXd& later) -> VectorXd {
      const Pose pose = T_WB * motion.After(at_s + later[0]);
      VectorXd zeta(6);
      zeta << so3::Log(then.rotation.transpose() * pose.rotation), pose.translation - then.translation;
      return zeta;
    };
    EXPECT_EQ(
        test::CompareJacobians(motion.Rates(T_WB.rotation, at_s), test::NumericJacobian(moved, 1), 1e-7), "");
  }
}

TEST(BodyMotionTest, TheCameraMovesWithTheBody) {
  RandomStates random(32);
  const Pose T_BC = random.RandomPose(0.3);
  const Pose T_WB = random.RandomPose(2);
  const NavState nav{T_WB.rotation, T_WB.translation, random.Vector(2)};
  const Vector3d bias = random.Vector(0.05);
  const BodyMotion motion = MotionOf({bias + random.Vector(1), random.Vector(5)}, bias, nav.R_WB, nav.v_WB);
  const Pose direct = T_WB * motion.After(0.01) * T_BC;
  const Pose by_camera = T_WB * T_BC * CameraAfter(motion, T_BC, 0.01);
  EXPECT_LT((direct.translation - by_camera.translation).norm(), 1e-12);
  EXPECT_LT((direct.rotation - by_camera.rotation).norm(), 1e-12);
  EXPECT_TRUE((T_WB * motion.After(0.01)).translation.isApprox(T_WB.translation + 0.01 * nav.v_WB));
}

}  // namespace
}  // namespace alidade
