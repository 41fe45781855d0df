#pragma once

#include <optional>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/rig_calibration.h"
#include "core/robust.h"
#include "filter/filter_state.h"
#include "gnss/alignment/alignment.h"
#include "gnss/model/epoch_rows.h"

namespace alidade {

/// The filter's part of GNSS: receiver clock in state and covariance, update with an epoch.
///
/// The clock's error is a leading block of the covariance, directly before the core: a row of the factor
/// depends on its own and later columns alone, so the clock's process noise involves only its six columns,
/// and a state without GNSS has no extra cost. Between epochs the clock is not propagated, since no other
/// state depends on it.
class GnssUpdate {
 public:
  GnssUpdate(const GnssConfig& config, const GnssReceiver& receiver);

  /// Null, the default, observes nothing. It must outlive the object.
  void SetObserver(FilterObserver* observer) { observer_ = observer; }

  /// Turns the state, which holds no landmarks, into the alignment's frame and enters the clock, if it is
  /// known.
  void Align(const GnssAlignment& alignment, FilterState* state);
  [[nodiscard]] bool aligned() const { return mount_.has_value(); }
  /// Back to a local world.
  void Reset() { mount_.reset(); }

  /// Updates the covariance with an epoch at the state's stamp; `correction` (the error's dimension) is what
  /// the caller then corrects state and clock by. False when a number is not finite.
  bool Apply(const GnssEpoch& epoch, const Eigen::Vector3d& gyro_radps, FilterState* state,
             Eigen::Ref<Eigen::VectorXd> correction, FrameStatistics* statistics);

  /// The correction of the clock by any update of the filter: `correction` of the whole error.
  void Correct(const Eigen::Ref<const Eigen::VectorXd>& correction, const FilterState& state);

  /// At the state's stamp.
  [[nodiscard]] ClockState Clock(const FilterState& state) const;
  [[nodiscard]] const GnssResiduals& residuals() const { return residuals_; }

 private:
  void PropagateClockTo(TimeNs stamp_ns, FilterState* state);
  void ResetClock(double step_m, FilterState* state);
  void FillRows(const FilterState& state);
  void Weigh(const FilterState& state, FrameStatistics* statistics);
  /// Rotates the rows into at most as many as they have columns; returns the squared norm of the innovations
  /// that are left without a row.
  double Compress();
  void NotifyObserver(const FilterState& state) const;

  GnssConfig config_;
  GnssReceiver receiver_;
  FilterObserver* observer_ = nullptr;
  double gate_threshold_;
  std::optional<AntennaMount> mount_;
  Vector6d clock_ = Vector6d::Zero();
  TimeNs clock_stamp_ns_ = 0;
  GnssResiduals residuals_;
  // Scratch kept between epochs.
  EpochMeasurements located_;
  std::vector<GnssRow> rows_;
  std::vector<double> nis_;
  /// Over clock and core, and the lever arm of a watched antenna, which is all that an epoch sees.
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd innovation_;
};

}  // namespace alidade
