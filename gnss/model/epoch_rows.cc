#include "gnss/model/epoch_rows.h"

#include <algorithm>
#include <cmath>

#include "core/robust.h"
#include "gnss/model/receiver_clock.h"

namespace alidade {
namespace {

bool IsBelowMask(const GnssConfig& config, const SatelliteMeasurement& m) {
  const double mask = config.corrections.elevation_mask_deg * M_PI / 180;
  return m.direction.elevation_rad < mask;
}

bool HasRateRow(const GnssConfig& config, const SatelliteMeasurement& m) {
  return config.doppler && m.range_rate_mps;
}

/// Of a state, with Jacobians over its error and over the lever arm.
struct AntennaMotion {
  AntennaMotion(const AntennaMount& mount, const GnssPoint& point)
      : position_E(mount.Position(point.nav, &position_jacobian)),
        velocity_E(mount.Velocity(point.nav, point.bias, point.gyro_radps, &velocity_jacobian)),
        position_by_arm(mount.PositionByLeverArm(point.nav)),
        velocity_by_arm(mount.VelocityByLeverArm(point.nav, point.bias, point.gyro_radps)) {}

  Eigen::Matrix<double, 3, 15> position_jacobian;
  Eigen::Matrix<double, 3, 15> velocity_jacobian;
  Eigen::Vector3d position_E;
  Eigen::Vector3d velocity_E;
  Eigen::Matrix3d position_by_arm;
  Eigen::Matrix3d velocity_by_arm;
};

GnssRow PseudorangeRow(const SatelliteMeasurement& m, const AntennaMotion& antenna, const Vector6d& clock) {
  GnssRow row;
  row.bias_index = ClockBiasIndex(m.satellite.system);
  row.deviation = std::sqrt(m.pseudorange_variance);
  row.contradicted = m.contradicted;
  const double clock_m = clock[ClockState::kClock] + (row.bias_index >= 0 ? clock[row.bias_index] : 0);
  RowVector3d line;
  PseudorangeModel::Of(m).Evaluate(antenna.position_E, clock_m, &row.residual, &line);
  row.jacobian.noalias() = line * antenna.position_jacobian;
  row.lever_arm.noalias() = line * antenna.position_by_arm;
  return row;
}

GnssRow RangeRateRow(const SatelliteMeasurement& m, const AntennaMotion& antenna, const Vector6d& clock) {
  GnssRow row;
  row.is_rate = true;
  row.deviation = std::sqrt(m.range_rate_variance);
  RowVector3d line;
  RowVector3d by_velocity;
  RangeRateModel::Of(m).Evaluate(antenna.position_E, antenna.velocity_E, clock[ClockState::kDrift],
                                 &row.residual, &line, &by_velocity);
  row.jacobian.noalias() = line * antenna.position_jacobian + by_velocity * antenna.velocity_jacobian;
  row.lever_arm.noalias() = line * antenna.position_by_arm + by_velocity * antenna.velocity_by_arm;
  return row;
}

}  // namespace

Eigen::Matrix<double, 1, 6> GnssRow::ClockJacobian() const {
  Eigen::Matrix<double, 1, 6> row = Eigen::Matrix<double, 1, 6>::Zero();
  row[is_rate ? ClockState::kDrift : ClockState::kClock] = 1;
  if (!is_rate && bias_index >= 0) {
    row[bias_index] = 1;
  }
  return row;
}

void LocateEpoch(const MeasurementBuilder& builder, const AntennaMount& mount, const NavState& nav,
                 EpochMeasurements* epoch) {
  builder.Locate(mount.Position(nav, nullptr), epoch);
}

std::vector<GnssRow> LinearizeEpoch(const GnssConfig& config, const AntennaMount& mount,
                                    const GnssPoint& point, const EpochMeasurements& epoch,
                                    GnssResiduals* residuals) {
  const AntennaMotion antenna(mount, point);
  std::vector<GnssRow> rows;
  std::vector<GnssRow> rates;
  residuals->satellites.clear();
  for (const SatelliteMeasurement& m : epoch.satellites) {
    if (IsBelowMask(config, m)) {
      continue;
    }
    SatelliteResidual satellite{m.satellite, m.direction,  0,    std::sqrt(m.pseudorange_variance),
                                false,       std::nullopt, false};
    const std::size_t index = residuals->satellites.size();
    GnssRow row = PseudorangeRow(m, antenna, point.clock);
    satellite.residual_m = row.residual;
    if (config.pseudorange) {
      row.satellite = index;
      row.information = epoch.noise.InformationShare(m.pseudorange_variance);
      rows.push_back(row);
    }
    if (HasRateRow(config, m)) {
      row = RangeRateRow(m, antenna, point.clock);
      row.satellite = index;
      satellite.range_rate_residual_mps = row.residual;
      rates.push_back(row);
    }
    residuals->satellites.push_back(satellite);
  }
  rows.insert(rows.end(), rates.begin(), rates.end());
  return rows;
}

std::size_t CountEpochRows(const GnssConfig& config, const EpochMeasurements& epoch) {
  std::size_t rows = 0;
  for (const SatelliteMeasurement& m : epoch.satellites) {
    if (!IsBelowMask(config, m)) {
      rows += (config.pseudorange ? 1 : 0) + (HasRateRow(config, m) ? 1 : 0);
    }
  }
  return rows;
}

double CommonStep(const std::vector<GnssRow>& rows) {
  std::vector<double> steps;
  for (const GnssRow& row : rows) {
    if (!row.is_rate) {
      steps.push_back(-row.residual);
    }
  }
  if (steps.empty()) {
    return 0;
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

bool IsClockJump(const GnssConfig& config, const std::vector<GnssRow>& rows, double step_m,
                 double clock_std_m) {
  constexpr int kLeastSatellites = 3;
  constexpr double kDeviations = 6;
  const auto ranges = std::count_if(rows.begin(), rows.end(), [](const GnssRow& r) { return !r.is_rate; });
  const double threshold = std::max(config.clock_jump_m, kDeviations * clock_std_m);
  return ranges >= kLeastSatellites && std::abs(step_m) > threshold;
}

double NormalisedInnovation(double residual, double of_state, bool contradicted) {
  return residual * residual / (1 + (contradicted ? 0 : of_state));
}

GnssWeights WeighRows(const GnssConfig& config, double gate_threshold, const std::vector<double>& nis) {
  GnssWeights result;
  result.weights.assign(nis.size(), 0);
  const auto refused =
      std::count_if(nis.begin(), nis.end(), [&](double value) { return !(value <= gate_threshold); });
  const bool suspect = StateIsSuspect(static_cast<int>(refused), static_cast<int>(nis.size()),
                                      config.max_gated_share, kLeastRefusedGnssRows);
  for (std::size_t i = 0; i < nis.size(); ++i) {
    if (nis[i] <= gate_threshold) {
      result.weights[i] = RobustWeight(config.robust_kernel, config.robust_scale_sigma, nis[i]);
    } else if (suspect && std::isfinite(nis[i])) {
      result.weights[i] = gate_threshold / nis[i];
    }
    ++(result.weights[i] > 0 ? result.used : result.refused);
  }
  return result;
}

}  // namespace alidade
