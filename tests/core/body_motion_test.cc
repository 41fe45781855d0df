#include "core/body_motion.h"

#include <gtest/gtest.h>

#include <cmath>

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

TEST(BodyMotionTest, ARampIsFoundWhereverTheInstantLies) {
  for (const double rate_hz : {50.0, 100.0, 1000.0}) {
    const std::vector<ImuSample> samples = Ramp(rate_hz, 100);
    for (const double at_s : {0.03, 0.0333, 0.04}) {
      for (const double span_s : {0.0, 0.005, 0.02}) {
        const MeasuredTurn turn = TurnAround(samples, SecondsToNs(at_s), span_s);
        EXPECT_LT((turn.gyro_radps - Vector3d(0.1 + 2 * at_s, -0.5 * at_s, 0.3)).norm(), 1e-7);
        EXPECT_LT((turn.alpha_radps2 - (span_s > 0 ? Vector3d(2, -0.5, 0) : Vector3d::Zero())).norm(), 1e-5);
      }
    }
  }
}

TEST(BodyMotionTest, SamplesThatEndAtTheInstantGiveTheRampToo) {
  const std::vector<ImuSample> samples = Ramp(200, 9);
  const MeasuredTurn turn = TurnAround(samples, SecondsToNs(0.04), 0.01);
  EXPECT_LT((turn.gyro_radps - Vector3d(0.18, -0.02, 0.3)).norm(), 1e-7);
  EXPECT_LT((turn.alpha_radps2 - Vector3d(2, -0.5, 0)).norm(), 1e-5);
  EXPECT_EQ(TurnAround(samples, SecondsToNs(0.1), 0.01).gyro_radps, samples.back().gyro);
  EXPECT_EQ(TurnAround(samples, SecondsToNs(-0.1), 0.01).gyro_radps, samples.front().gyro);
  EXPECT_EQ(TurnAround({}, 0, 0.01).gyro_radps, Vector3d::Zero());
}

TEST(BodyMotionTest, AVibrationDoesNotLastOverTheSpan) {
  // 100 Hz about x, at its crest at the instant: over 20 ms it turns the body nowhere.
  std::vector<ImuSample> samples;
  for (int k = 0; k < 100; ++k) {
    const double t_s = k / 1000.0;
    samples.push_back(
        {SecondsToNs(t_s), Vector3d(std::cos(2 * M_PI * 100 * (t_s - 0.05)), 0, 0), Vector3d::Zero()});
  }
  const MeasuredTurn turn = TurnAround(samples, SecondsToNs(0.05), 0.01);
  EXPECT_LT(turn.gyro_radps.norm(), 1e-6);
  EXPECT_LT(turn.alpha_radps2.norm(), 1e-3);
  EXPECT_NEAR(TurnAround(samples, SecondsToNs(0.05), 0).gyro_radps.x(), 1, 1e-9);
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

TEST(BodyMotionTest, TheChainOfARowIsThatOfCentralDifferences) {
  RandomStates random(33);
  for (int trial = 0; trial < 20; ++trial) {
    const BodyMotion motion{random.Vector(3), random.Vector(20), random.Vector(4)};
    const Pose T_WB = random.RandomPose(2);
    const Pose T_BC = random.RandomPose(0.3);
    const Pose T_WC = T_WB * T_BC;
    const double line_delay_s = 5e-3;
    const double row_px = random.Uniform(-4, 4);
    const ExposedRow row = ExposeRow(motion, T_BC, T_WB.rotation, line_delay_s, row_px);
    const Pose T_WR = T_WC * row.T_CR;
    const Pose body_then = T_WB * motion.After(line_delay_s * row_px);
    EXPECT_LT((T_WR.translation - (body_then * T_BC).translation).norm(), 1e-12);
    EXPECT_LT((row.R_WB - body_then.rotation).norm(), 1e-12);
    const auto from_row = [&](const Pose& moved) -> VectorXd {
      return (Vector6d() << so3::Log(T_WR.rotation.transpose() * moved.rotation),
              moved.translation - T_WR.translation)
          .finished();
    };
    const auto of_camera = [&](const VectorXd& zeta) -> VectorXd {
      return from_row(Retract(ErrorConvention::kSo3xRn, T_WC, Vector6d(zeta)) * row.T_CR);
    };
    EXPECT_EQ(test::CompareJacobians(row.row_from_camera, test::NumericJacobian(of_camera, 6), 1e-8), "");
    const auto of_line_delay = [&](const VectorXd& longer) -> VectorXd {
      return from_row(T_WB * motion.After((line_delay_s + longer[0]) * row_px) * T_BC);
    };
    EXPECT_EQ(test::CompareJacobians(row.row_from_line_delay, test::NumericJacobian(of_line_delay, 1), 1e-7),
              "");
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
