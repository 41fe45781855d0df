#include "gnss/model/measurement_model.h"

#include "core/check.h"
#include "core/lever_arm.h"
#include "gnss/base/constants.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kSagnac = kEarthRotationRate / kSpeedOfLight;  // [1/m]

}  // namespace

PseudorangeModel PseudorangeModel::Of(const SatelliteMeasurement& m) {
  return {m.pseudorange_m, m.state.position_E,
          -m.state.clock_m + m.troposphere_m + m.ionosphere_m + m.group_delay_m};
}

void PseudorangeModel::Evaluate(const Vector3d& antenna_E, double clock_m, double* residual,
                                RowVector3d* position_jacobian) const {
  const Vector3d& s = satellite_position_E;
  const Vector3d apart = s - antenna_E;
  const double range = apart.norm();
  const double sagnac = kSagnac * (s.x() * antenna_E.y() - s.y() * antenna_E.x());
  *residual = range + sagnac + clock_m + correction_m - measured_m;
  if (position_jacobian != nullptr) {
    *position_jacobian = -apart.transpose() / range + kSagnac * RowVector3d(-s.y(), s.x(), 0);
  }
}

RangeRateModel RangeRateModel::Of(const SatelliteMeasurement& m) {
  CHECK(m.range_rate_mps.has_value());
  return {*m.range_rate_mps, m.state};
}

void RangeRateModel::Evaluate(const Vector3d& antenna_E, const Vector3d& velocity_E, double drift_mps,
                              double* residual, RowVector3d* position_jacobian,
                              RowVector3d* velocity_jacobian) const {
  const Vector3d& s = satellite.position_E;
  const Vector3d& vs = satellite.velocity_E;
  const Vector3d apart = s - antenna_E;
  const double range = apart.norm();
  const Vector3d e = apart / range;
  const Vector3d relative = vs - velocity_E;
  const double sagnac = kSagnac * (vs.x() * antenna_E.y() + s.x() * velocity_E.y() - vs.y() * antenna_E.x() -
                                   s.y() * velocity_E.x());
  const double rate = e.dot(relative) + sagnac;
  const double flight = 1 + e.dot(vs) / kSpeedOfLight;
  *residual = rate / flight + drift_mps - satellite.drift_mps - measured_mps;
  if (velocity_jacobian != nullptr) {
    *velocity_jacobian = (-e.transpose() + kSagnac * RowVector3d(-s.y(), s.x(), 0)) / flight;
  }
  if (position_jacobian != nullptr) {
    // d e / d p_A = -(I - e e^T) / range
    const RowVector3d rate_jacobian =
        -(relative - e.dot(relative) * e).transpose() / range + kSagnac * RowVector3d(-vs.y(), vs.x(), 0);
    const RowVector3d flight_jacobian = -(vs - e.dot(vs) * e).transpose() / (range * kSpeedOfLight);
    *position_jacobian = rate_jacobian / flight - rate / (flight * flight) * flight_jacobian;
  }
}

Eigen::Matrix3d AntennaMount::PositionByLeverArm(const NavState& state) const {
  return enu.R_EN * LeverArm::PositionByArm(state);
}

Eigen::Matrix3d AntennaMount::VelocityByLeverArm(const NavState& state, const ImuBias& bias,
                                                 const Vector3d& gyro_radps) const {
  return PositionByLeverArm(state) * LeverArm::SwingByArm(bias, gyro_radps);
}

Vector3d AntennaMount::Position(const NavState& state, Eigen::Matrix<double, 3, 15>* jacobian) const {
  const Vector3d p_WA = LeverArm{p_BA}.Position(state, jacobian);
  if (jacobian != nullptr) {
    *jacobian = enu.R_EN * *jacobian;
  }
  return enu.ToEcef(p_WA);
}

Vector3d AntennaMount::Velocity(const NavState& state, const ImuBias& bias, const Vector3d& gyro_radps,
                                Eigen::Matrix<double, 3, 15>* jacobian) const {
  const Vector3d v_WA = LeverArm{p_BA}.Velocity(state, bias, gyro_radps, jacobian);
  if (jacobian != nullptr) {
    *jacobian = enu.R_EN * *jacobian;
  }
  return enu.R_EN * v_WA;
}

}  // namespace alidade
