#pragma once

#include <Eigen/Core>
#include <span>

#include "core/imu_sample.h"
#include "core/navigation_state.h"

namespace alidade {

/// How a body moves on around an instant, over some hundredths of a second: its rate grows linearly, its
/// velocity stays. In the body's own axes at that instant, so that an error of the body's pose there moves
/// what follows like a rigid body.
struct BodyMotion {
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d alpha_B = Eigen::Vector3d::Zero();  ///< [rad/s^2]
  Eigen::Vector3d v_B = Eigen::Vector3d::Zero();      ///< [m/s]

  /// The body `later_s` seconds later (negative: before), in its own frame at the instant: rotation
  /// Exp(omega s + alpha s^2 / 2), translation v s.
  [[nodiscard]] Pose After(double later_s) const;
  /// d zeta / d later_s of that pose in the canonical chart, the body being turned by R_WB at the instant:
  /// (J_r (omega + alpha s), R_WB v), J_r the right Jacobian at the turn until then.
  [[nodiscard]] Vector6d Rates(const Eigen::Matrix3d& R_WB, double later_s) const;

 private:
  [[nodiscard]] Eigen::Vector3d TurnAfter(double later_s) const;
};

/// A body's turn around an instant, from the gyroscope.
struct MeasuredTurn {
  Eigen::Vector3d gyro_radps = Eigen::Vector3d::Zero();    ///< at the instant
  Eigen::Vector3d alpha_radps2 = Eigen::Vector3d::Zero();  ///< its change with time
};
/// The line in time that fits the linearly interpolated gyroscope best, in the mean of squares from `span_s`
/// before the instant until `span_s` after it, as far as the samples reach. One sample at the instant would
/// carry the vibration of that moment over the whole span. A span of 0 gives the interpolated sample.
/// `samples`: in time order; without any all is zero.
[[nodiscard]] MeasuredTurn TurnAround(std::span<const ImuSample> samples, TimeNs stamp_ns, double span_s);
/// The motion of a body there. `gyro_bias` [rad/s], v_WB [m/s] in the world's axes.
[[nodiscard]] BodyMotion MotionOf(const MeasuredTurn& turn, const Eigen::Vector3d& gyro_bias,
                                  const Eigen::Matrix3d& R_WB, const Eigen::Vector3d& v_WB);

/// The camera of a body in motion, s seconds after the instant, from its own frame at the instant:
/// T_BC^-1 After(s) T_BC.
[[nodiscard]] Pose CameraAfter(const BodyMotion& motion, const Pose& T_BC, double later_s);

/// The camera of a body in motion when a rolling shutter exposed a row r: what carries a camera C of the
/// instant, and the chain of its error, to that row. Charts are the canonical (phi, dp) of the pose in W.
struct ExposedRow {
  Pose T_CR;                     ///< T_WR = T_WC T_CR
  Matrix6d row_from_camera;      ///< d zeta_R / d zeta_C, the body in motion as one rigid body
  Eigen::Matrix3d R_WB;          ///< of the body when the row was exposed
  Vector6d row_from_line_delay;  ///< d zeta_R / d line delay: row_px times [rad/s, m/s]
};
/// `row_px`: the row less that exposed at the instant; it is exposed line_delay_s * row_px later. R_WB: of
/// the body at the instant, where the Jacobians are taken; the camera's rotation is R_WB R_BC.
[[nodiscard]] ExposedRow ExposeRow(const BodyMotion& motion, const Pose& T_BC, const Eigen::Matrix3d& R_WB,
                                   double line_delay_s, double row_px);

}  // namespace alidade
