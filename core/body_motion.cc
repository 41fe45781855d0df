#include "core/body_motion.h"

#include "core/check.h"
#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Over less the noise of two samples, of an IMU at 1 kHz, would turn a row by more than a pixel's tenth.
constexpr TimeNs kLeastSpanNs = 10'000'000;

}  // namespace

Vector3d BodyMotion::TurnAfter(double later_s) const {
  return later_s * (omega_B + 0.5 * later_s * alpha_B);
}

Pose BodyMotion::After(double later_s) const {
  return {so3::Exp(TurnAfter(later_s)), later_s * v_B};
}

Vector6d BodyMotion::Rates(const Matrix3d& R_WB, double later_s) const {
  const Vector3d rate_B = so3::RightJacobian(TurnAfter(later_s)) * (omega_B + later_s * alpha_B);
  return (Vector6d() << rate_B, R_WB * v_B).finished();
}

MeasuredTurn TurnAtEnd(std::span<const ImuSample> samples) {
  CHECK(!samples.empty());
  const ImuSample& last = samples.back();
  MeasuredTurn turn{last.gyro, Vector3d::Zero()};
  std::size_t first = samples.size() - 1;
  while (first > 0 && last.stamp_ns - samples[first].stamp_ns < kLeastSpanNs) {
    --first;
  }
  if (samples[first].stamp_ns < last.stamp_ns) {
    turn.alpha_radps2 =
        (last.gyro - samples[first].gyro) / SecondsBetween(samples[first].stamp_ns, last.stamp_ns);
  }
  return turn;
}

BodyMotion MotionOf(const MeasuredTurn& turn, const Vector3d& gyro_bias, const Matrix3d& R_WB,
                    const Vector3d& v_WB) {
  return {turn.gyro_radps - gyro_bias, turn.alpha_radps2, R_WB.transpose() * v_WB};
}

Pose CameraAfter(const BodyMotion& motion, const Pose& T_BC, double later_s) {
  return T_BC.Inverse() * motion.After(later_s) * T_BC;
}

}  // namespace alidade
