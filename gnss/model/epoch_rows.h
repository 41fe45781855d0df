#pragma once

#include <cstddef>
#include <vector>

#include "core/clock_state.h"
#include "core/gnss_config.h"
#include "gnss/model/gnss_epoch.h"
#include "gnss/model/measurement_model.h"

namespace alidade {

/// One pseudorange or range rate of an epoch, linearised: the models of gnss/model/measurement_model.h at the
/// antenna of a state.
struct GnssRow {
  std::size_t satellite = 0;  ///< in GnssResiduals::satellites
  bool is_rate = false;
  int bias_index = -1;  ///< of the system in ClockState, -1: none; of a pseudorange
  double residual = 0;  ///< predicted - measured [m] or [m/s]
  double deviation = 1;
  /// Factor on its information beside the deviation, by which it is gated (PseudorangeNoise).
  double information = 1;
  bool contradicted = false;                    ///< SatelliteMeasurement
  GnssJacobian jacobian;                        ///< over (phi, dp, dv, dbg, dba)
  RowVector3d lever_arm = RowVector3d::Zero();  ///< d residual / d p_BA

  /// d residual / d clock state.
  [[nodiscard]] Eigen::Matrix<double, 1, 6> ClockJacobian() const;
};

/// Where an epoch is linearised.
struct GnssPoint {
  NavState nav;
  ImuBias bias;
  Eigen::Vector3d gyro_radps = Eigen::Vector3d::Zero();  ///< as measured at the epoch
  Vector6d clock = Vector6d::Zero();
};

/// Directions, atmosphere and variances of the epoch at the antenna's predicted position.
void LocateEpoch(const MeasurementBuilder& builder, const AntennaMount& mount, const NavState& nav,
                 EpochMeasurements* epoch);

/// Rows of every satellite above the mask, pseudoranges first, as far as the configuration uses them; fills
/// `residuals` with those satellites, none used yet. The epoch must be located.
[[nodiscard]] std::vector<GnssRow> LinearizeEpoch(const GnssConfig& config, const AntennaMount& mount,
                                                  const GnssPoint& point, const EpochMeasurements& epoch,
                                                  GnssResiduals* residuals);

/// Their number, which does not depend on the point.
[[nodiscard]] std::size_t CountEpochRows(const GnssConfig& config, const EpochMeasurements& epoch);

/// Median of measured - predicted over the pseudoranges: the clock's error, whatever a minority of them
/// reads. Zero without any.
[[nodiscard]] double CommonStep(const std::vector<GnssRow>& rows);

/// Whether that step is the clock's: beyond clock_jump_m and six deviations `clock_std_m`, and seen by at
/// least three satellites.
[[nodiscard]] bool IsClockJump(const GnssConfig& config, const std::vector<GnssRow>& rows, double step_m,
                               double clock_std_m);

/// Normalised innovation squared of a whitened residual, with the whitened variance `of_state` of its
/// prediction. That of a contradicted pseudorange does not count: an uncertain state is no argument for what
/// most satellites speak against.
[[nodiscard]] double NormalisedInnovation(double residual, double of_state, bool contradicted);

/// What gate and kernel make of rows with these normalised innovations squared (one degree of freedom each).
struct GnssWeights {
  std::vector<double> weights;  ///< 0: refused
  int used = 0;
  int refused = 0;
};
/// Each row is used below the gate, with its kernel's weight. When the state is suspect and not the
/// satellites (StateIsSuspect in core/robust.h), all are used, those beyond the gate scaled down to it.
[[nodiscard]] GnssWeights WeighRows(const GnssConfig& config, double gate_threshold,
                                    const std::vector<double>& nis);

}  // namespace alidade
