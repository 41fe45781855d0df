#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/fix_config.h"
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
  [[nodiscard]] Eigen::Vector3d Predict(const NavState& state) const {
    return state.p_WB + state.R_WB * p_BA;
  }
  void Evaluate(const NavState& state, Eigen::Vector3d* residual, Jacobian* jacobian) const;
};

/// PositionFixModel with its noise: what filter, smoother and batch use of a fix.
struct FixMeasurement {
  PositionFixModel model;
  Eigen::Matrix3d sqrt_information = Eigen::Matrix3d::Identity();  ///< lower triangular

  /// Whitened.
  void Evaluate(const NavState& state, Eigen::Vector3d* residual, PositionFixModel::Jacobian* jacobian) const;
};

/// The fix with the noise that the configuration assumes: covariance std_scale^2 C + std_floor_m^2 I. kInput:
/// a number is not finite, or the covariance is not symmetric positive definite.
[[nodiscard]] Result<FixMeasurement> MakeFixMeasurement(const FixConfig& config, const Eigen::Vector3d& p_BA,
                                                        const PositionFix& fix);

/// The same with the lever arm of the fix's sensor. kInput also: a sensor that `sensors` does not have.
[[nodiscard]] Result<FixMeasurement> MakeFixMeasurement(const FixConfig& config,
                                                        const std::vector<FixSensor>& sensors,
                                                        const PositionFix& fix);

/// Normalised innovation squared of a whitened residual and its Jacobian, 3x15, over the errors that
/// `covariance` is of.
[[nodiscard]] double FixNis(const Eigen::Vector3d& residual, const PositionFixModel::Jacobian& jacobian,
                            const Matrix15d& covariance);

/// Gate and kernel of fixes in their order of time, shared by the back ends.
///
/// A fix inside the gate has its kernel's weight; one outside has none. When more than max_refused_run of
/// them are refused in a row, the state is suspect and not the fixes: they are used, scaled down to the gate,
/// until one is inside again.
class FixGate {
 public:
  explicit FixGate(const FixConfig& config);

  /// The weight of a fix's information, in [0, 1]; 0: refused. `nis`: normalised innovation squared, 3
  /// degrees of freedom.
  double Weigh(double nis);
  void Reset() { refused_in_a_row_ = 0; }

 private:
  FixConfig config_;
  double threshold_;
  int refused_in_a_row_ = 0;
};

}  // namespace alidade
