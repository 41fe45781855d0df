#pragma once

#include <Eigen/Core>

#include "core/navigation_state.h"
#include "gnss/base/geodesy.h"
#include "gnss/model/satellite_measurement.h"

namespace alidade {

// Pseudorange and Doppler of an antenna A, with the satellite S at transmission in the ECEF axes of
// transmission, e the unit vector from A to S, w the Earth's rotation rate and all clocks in metres:
//
//   P         = |p_S - p_A| + (w/c)(x_S y_A - y_S x_A) + c dt_r + c b_sys - c dt_S + T + I + c TGD
//   -lambda D = [ e.(v_S - v_A) + (w/c)(vx_S y_A + x_S vy_A - vy_S x_A - y_S vx_A) ] / (1 + e.v_S / c)
//               + c ddt_r - c ddt_S
//
// The term in w is the rotation of the Earth during the flight (Sagnac) to first order: 1 mm is left. Its
// rate has the sign given here; with the other sign a static receiver climbs by 6 to 9 mm/s. Neglected: rates
// of the atmosphere (below 1 mm/s), Shapiro delay (2 cm, nearly common).

using RowVector3d = Eigen::RowVector3d;

/// The pseudorange as a model of antenna position and clock.
struct PseudorangeModel {
  double measured_m = 0;
  Eigen::Vector3d satellite_position_E = Eigen::Vector3d::Zero();
  double correction_m = 0;  ///< -c dt_S + T + I + c TGD, added to the prediction

  [[nodiscard]] static PseudorangeModel Of(const SatelliteMeasurement& measurement);

  /// residual = predicted - measured [m]; `clock_m` = c dt_r + c b_sys, its Jacobian is 1.
  /// `position_jacobian`: d residual / d p_A, 1x3 in ECEF, may be null.
  void Evaluate(const Eigen::Vector3d& antenna_E, double clock_m, double* residual,
                RowVector3d* position_jacobian) const;
};

/// The range rate -lambda D as a model of antenna position, velocity and clock drift.
struct RangeRateModel {
  double measured_mps = 0;
  SatelliteState satellite;

  /// Precondition: the measurement has a range rate.
  [[nodiscard]] static RangeRateModel Of(const SatelliteMeasurement& measurement);

  /// residual = predicted - measured [m/s]; drift_mps = c ddt_r, its Jacobian is 1. Jacobians 1x3 with
  /// respect to antenna position and velocity in ECEF, may be null.
  void Evaluate(const Eigen::Vector3d& antenna_E, const Eigen::Vector3d& velocity_E, double drift_mps,
                double* residual, RowVector3d* position_jacobian, RowVector3d* velocity_jacobian) const;
};

/// Antenna of a body whose world is the ENU frame at an anchor, at a lever arm (core/lever_arm.h).
struct AntennaMount {
  EnuFrame enu;
  Eigen::Vector3d p_BA = Eigen::Vector3d::Zero();

  /// d Position / d p_BA and d Velocity / d p_BA, 3x3 each.
  [[nodiscard]] Eigen::Matrix3d PositionByLeverArm(const NavState& state) const;
  [[nodiscard]] Eigen::Matrix3d VelocityByLeverArm(const NavState& state, const ImuBias& bias,
                                                   const Eigen::Vector3d& gyro_radps) const;
  /// Antenna position in ECEF [m]. `jacobian`: 3x15 over (phi, dp, dv, dbg, dba), may be null.
  [[nodiscard]] Eigen::Vector3d Position(const NavState& state, Eigen::Matrix<double, 3, 15>* jacobian) const;
  /// Antenna velocity in ECEF axes [m/s]; gyro_radps is the measured rate at the stamp.
  [[nodiscard]] Eigen::Vector3d Velocity(const NavState& state, const ImuBias& bias,
                                         const Eigen::Vector3d& gyro_radps,
                                         Eigen::Matrix<double, 3, 15>* jacobian) const;
};

/// d residual / d (phi, dp, dv, dbg, dba): the canonical chart of core/model.h, the models' Jacobians times
/// AntennaMount's (LinearizeEpoch). Other error conventions: times ImuChartJacobian
/// (core/error_convention.h).
using GnssJacobian = Eigen::Matrix<double, 1, 15>;

}  // namespace alidade
