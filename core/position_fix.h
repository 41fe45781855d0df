#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/fix_config.h"
#include "core/lever_arm.h"
#include "core/measurement_gate.h"
#include "core/navigation_state.h"
#include "core/status.h"

namespace alidade {

/// A sensor that measures the position of a point A of the body: a GNSS receiver's own solution (RTK, PPP),
/// motion capture, UWB.
struct FixSensor {
  Eigen::Vector3d p_BA = Eigen::Vector3d::Zero();  ///< A in the body frame [m]
  double time_offset_s = 0;                        ///< t_imu = t_fix + offset
  /// Latitude [deg], longitude [deg], height above the ellipsoid [m] (WGS 84) of the origin of the ENU frame
  /// that the fixes stand in. Without it they stand in a gravity-aligned frame of the sensor's own, z up.
  std::optional<Eigen::Vector3d> anchor_llh_deg = std::nullopt;
};

/// One measured position. In a log: the sensor's own clock and frame. As an estimator takes it: IMU time, and
/// the world frame W after the alignment.
struct PositionFix {
  TimeNs stamp_ns = 0;
  int sensor = 0;                                            ///< index in RigCalibration::fixes
  Eigen::Vector3d p_A = Eigen::Vector3d::Zero();             ///< [m]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of p_A [m^2], positive definite
};

/// The model of a position fix (core/model.h):
///
///   r = p_WB + R_WB p_BA - p_WA,   3x1, m.
///
/// Jacobian over the 15 canonical coordinates (phi, dp, dv, dbg, dba). Neglected: the motion during the
/// sensor's averaging time and the correlation of its errors in time.
struct PositionFixModel {
  static constexpr int kRows = 3;
  using Jacobian = Eigen::Matrix<double, kRows, 15>;

  Eigen::Vector3d p_BA = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_WA = Eigen::Vector3d::Zero();  ///< measured

  /// The predicted position of A, p_WB + R_WB p_BA.
  [[nodiscard]] Eigen::Vector3d Predict(const NavState& state) const;
  void Evaluate(const NavState& state, Eigen::Vector3d* residual, Jacobian* jacobian) const;
};

/// PositionFixModel with its noise: what filter, smoother and batch use of a fix.
struct FixMeasurement {
  static constexpr int kRows = PositionFixModel::kRows;
  using Residual = Eigen::Vector3d;
  using Jacobian = PositionFixModel::Jacobian;

  PositionFixModel model;
  Eigen::Matrix3d sqrt_information = Eigen::Matrix3d::Identity();  ///< lower triangular

  /// d (whitened residual) / d p_BA, 3x3.
  [[nodiscard]] Eigen::Matrix3d LeverArmJacobian(const NavState& state) const {
    return sqrt_information * LeverArm::PositionByArm(state);
  }
  /// Whitened.
  void Evaluate(const NavState& state, Residual* residual, Jacobian* jacobian) const;
  /// Multiplies the information by the square of `root`.
  void ScaleSqrtInformation(double root);
};

/// The fix with the noise that the configuration assumes: covariance std_scale^2 C + std_floor_m^2 I. kInput:
/// a number is not finite, or the covariance is not symmetric positive definite.
[[nodiscard]] Result<FixMeasurement> MakeFixMeasurement(const FixConfig& config, const Eigen::Vector3d& p_BA,
                                                        const PositionFix& fix);

/// The same with the lever arm of the fix's sensor. kInput also: a sensor that `sensors` does not have.
[[nodiscard]] Result<FixMeasurement> MakeFixMeasurement(const FixConfig& config,
                                                        const std::vector<FixSensor>& sensors,
                                                        const PositionFix& fix);

/// Gate and kernel of the fixes of one run.
[[nodiscard]] MeasurementGate MakeFixGate(const FixConfig& config);

}  // namespace alidade
