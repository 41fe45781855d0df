#pragma once

#include <optional>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/rig_calibration.h"
#include "gnss/alignment/alignment.h"
#include "smoother/factors/gnss_factors.h"
#include "smoother/factors/prior_factor.h"
#include "smoother/window/window.h"

namespace alidade {

/// The smoother's part of GNSS. Every frame has a clock block, tied to the next one by the clock's process;
/// an epoch is attached to the frame before it. Prior and marginalisation take the first frame's clock along.
class GnssWindow {
 public:
  GnssWindow(const GnssConfig& config, const GnssReceiver& receiver, const Eigen::Vector3d& gravity_W);

  void Reset() { context_.reset(); }
  [[nodiscard]] bool aligned() const { return context_.has_value(); }
  /// Null before Align.
  [[nodiscard]] const GnssFactorContext* context() const { return context_ ? &*context_ : nullptr; }

  /// From now on; the window is one frame, which gets its clock, and `prior` that clock's columns.
  void Align(const GnssAlignment& alignment, WindowFrame* frame, LinearPrior* prior);
  /// The clock of a frame that was just added, from that of the frame `from` before it.
  void PredictClock(const WindowFrame& from, WindowFrame* frame);

  /// Links the epoch to the frame; `imu` spans from the frame to the epoch, empty at the frame itself.
  /// Contradicted pseudoranges beyond the gate at the prediction take no part until Gate. False
  /// when the epoch was skipped because the clock was lost; it is re-initialised at the next frame.
  bool Attach(const GnssEpoch& epoch, std::vector<ImuSample> imu, const ImuNoise& noise, WindowFrame* frame);
  /// After a solve: the gate of each row of each epoch of a frame; statistics of those that are gated for
  /// the first time.
  void Gate(WindowFrame* frame, FrameStatistics* statistics);

  [[nodiscard]] double gate_threshold() const { return gate_threshold_; }
  [[nodiscard]] const GnssResiduals& residuals() const { return residuals_; }
  [[nodiscard]] bool jumped() const { return jumped_; }
  /// Median over the pseudoranges of the epoch attached last, less whole milliseconds: measured less
  /// predicted with the clock of its frame [m].
  [[nodiscard]] double step_m() const { return step_m_; }

 private:
  /// At the state and clock that the frame predicts for the epoch.
  [[nodiscard]] std::vector<GnssRow> PredictRows(const FrameEpoch& epoch, const WindowFrame& frame) const;
  /// Looks for a jump of the clock in the predicted rows and takes whole milliseconds out of epoch and rows;
  /// false when the clock is lost, by this or an earlier jump of another size.
  bool RemoveClockJump(FrameEpoch* epoch, std::vector<GnssRow>* rows);

  GnssConfig config_;
  GnssReceiver receiver_;
  Eigen::Vector3d gravity_W_;
  double gate_threshold_;
  std::optional<GnssFactorContext> context_;
  double removed_jumps_m_ = 0;  ///< taken out of the pseudoranges since
  TimeNs clock_known_ns_ = 0;   ///< of the last epoch with satellites
  bool clock_lost_ = false;
  bool jumped_ = false;
  double step_m_ = 0;
  GnssResiduals residuals_;
};

}  // namespace alidade
