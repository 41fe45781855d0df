#include "core/body_motion.h"

#include <algorithm>

#include "core/imu_buffer.h"
#include "core/lie.h"
#include "core/visual_observation.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

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

MeasuredTurn TurnAround(std::span<const ImuSample> samples, TimeNs stamp_ns, double span_s) {
  if (samples.empty()) {
    return {};
  }
  const TimeNs from_ns = std::max(samples.front().stamp_ns, stamp_ns - SecondsToNs(span_s));
  const TimeNs to_ns = std::min(samples.back().stamp_ns, stamp_ns + SecondsToNs(span_s));
  const TimeNs middle_ns = from_ns + (to_ns - from_ns) / 2;
  const double half_s = 0.5 * SecondsBetween(from_ns, to_ns);
  Vector3d area = Vector3d::Zero();    // integral of the rate
  Vector3d moment = Vector3d::Zero();  // integral of the rate times the time since the middle
  const auto after =
      std::upper_bound(samples.begin(), samples.end(), from_ns,
                       [](TimeNs stamp, const ImuSample& sample) { return stamp < sample.stamp_ns; });
  if (to_ns <= from_ns) {
    const bool between =
        after != samples.begin() && after != samples.end() && (after - 1)->stamp_ns < from_ns;
    const ImuSample& nearest = after == samples.begin() ? *after : *(after - 1);
    return {(between ? Interpolate(nearest, *after, from_ns) : nearest).gyro, Vector3d::Zero()};
  }
  for (auto next = after; next != samples.end() && (next - 1)->stamp_ns < to_ns; ++next) {
    const TimeNs begin_ns = std::max((next - 1)->stamp_ns, from_ns);
    const TimeNs end_ns = std::min(next->stamp_ns, to_ns);
    const Vector3d begin = Interpolate(*(next - 1), *next, begin_ns).gyro;
    const Vector3d end = Interpolate(*(next - 1), *next, end_ns).gyro;
    const double begin_s = SecondsBetween(middle_ns, begin_ns);
    const double end_s = SecondsBetween(middle_ns, end_ns);
    area += 0.5 * (end_s - begin_s) * (begin + end);
    // Simpson's rule, exact here.
    moment += (end_s - begin_s) / 6 * (begin_s * begin + (begin_s + end_s) * (begin + end) + end_s * end);
  }
  const Vector3d slope = 1.5 / (half_s * half_s * half_s) * moment;
  return {0.5 / half_s * area + SecondsBetween(middle_ns, stamp_ns) * slope, slope};
}

BodyMotion MotionOf(const MeasuredTurn& turn, const Vector3d& gyro_bias, const Matrix3d& R_WB,
                    const Vector3d& v_WB) {
  return {turn.gyro_radps - gyro_bias, turn.alpha_radps2, R_WB.transpose() * v_WB};
}

Pose CameraAfter(const BodyMotion& motion, const Pose& T_BC, double later_s) {
  return T_BC.Inverse() * motion.After(later_s) * T_BC;
}

ExposedRow ExposeRow(const BodyMotion& motion, const Pose& T_BC, const Matrix3d& R_WB, double line_delay_s,
                     double row_px) {
  const double later_s = line_delay_s * row_px;
  const Matrix3d R_WC = R_WB * T_BC.rotation;
  ExposedRow row;
  row.T_CR = CameraAfter(motion, T_BC, later_s);
  row.row_from_camera = BodyToCameraJacobian(R_WC, row.T_CR);
  row.R_WB = R_WB * motion.After(later_s).rotation;
  row.row_from_line_delay = row_px * (BodyToCameraJacobian(row.R_WB, T_BC) * motion.Rates(R_WB, later_s));
  return row;
}

}  // namespace alidade
