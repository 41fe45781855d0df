#pragma once

#include <Eigen/Core>

#include "core/navigation_state.h"

namespace alidade {

/// What relates the poses of a recorded truth to the body. T is the frame of the truth, M the frame whose
/// poses it holds (a marker), W the gravity-aligned world with the origin of T and without a turn about the
/// vertical against it: R_TW is the least rotation that turns the vertical of W into that of T.
///
///   T_TM(t) = R_TW T_WB(t + time_offset_s) T_BM
struct TruthConstants {
  Eigen::Matrix3d R_TW = Eigen::Matrix3d::Identity();
  Pose T_BM;
  double time_offset_s = 0;  ///< t_imu = t_truth + offset
};

/// Error of TruthConstants, in this order: tilt (2), R_TW = R_TW^ Exp((tilt, 0)) [rad]; marker rotation (3),
/// R_BM = R_BM^ Exp(.) [rad]; lever arm p_BM (3) [m]; time offset (1) [s].
inline constexpr int kTruthConstants = 9;
inline constexpr int kTiltColumn = 0;
inline constexpr int kMarkerColumn = 2;
inline constexpr int kLeverColumn = 5;
inline constexpr int kTimeColumn = 8;
using TruthConstantsError = Eigen::Matrix<double, kTruthConstants, 1>;
using TruthConstantsCovariance = Eigen::Matrix<double, kTruthConstants, kTruthConstants>;

/// The constants moved by an error; R_TW stays the least rotation between the two verticals, which differs
/// from R_TW^ Exp((tilt, 0)) in the second order.
[[nodiscard]] TruthConstants Retract(const TruthConstants& constants, const TruthConstantsError& error);

/// Residual of a recorded pose; see core/model.h for the contract of a model.
///
///   r = [ Log(R_meas^T R_TW R_WB R_BM) ;  R_TW (p_WB + R_WB p_BM) - p_meas ]        [rad, m]
///
/// The state is that at the pose's time, and the time offset moves it along its velocity and angular rate.
/// Neglected: that the velocity changes meanwhile (of second order in the change of the offset).
struct TruthPoseModel {
  Pose T_TM_measured;

  /// `angular_rate_B` [rad/s], without bias. Jacobians over (phi, dp, dv) of the state, 6x9, and over
  /// TruthConstantsError, 6x9; nullptr skips.
  void Evaluate(const NavState& state, const Eigen::Vector3d& angular_rate_B, const TruthConstants& constants,
                Vector6d* residual, Eigen::Matrix<double, 6, 9>* jacobian_state,
                Eigen::Matrix<double, 6, kTruthConstants>* jacobian_constants) const;
};

}  // namespace alidade
