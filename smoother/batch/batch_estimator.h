#pragma once

#include <memory>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/estimator_config.h"
#include "core/imu_buffer.h"
#include "core/rig_calibration.h"
#include "smoother/batch/batch_sequence.h"

namespace alidade {

/// The maximum-a-posteriori estimate over the whole sequence (smoother/batch/batch_solver.h): every state
/// given ALL data, the later ones too. A bound for other estimators, not a rival (docs/batch.md).
///
/// While the sequence runs, `initial`, another estimator on the same input, answers for it; its states are
/// the initial values, and the frames it accepts are the frames of the batch. TakeFinalized then solves.
///
/// Measurements between frames, GNSS epochs too, enter from the alignment on, which gives initial values and
/// leaves yaw and position of the prior free. The few before it are not used.
class BatchEstimator final : public Estimator {
 public:
  BatchEstimator(const EstimatorConfig& config, const RigCalibration& rig,
                 std::unique_ptr<Estimator> initial);

  Status Initialize(const NavEstimate& initial) override;
  Status AddImu(const ImuSample& sample) override;
  Status AddFrame(const TrackFrame& frame) override;
  Status Align(const GnssAlignment& alignment) override;
  Status AddGnss(const GnssEpoch& epoch) override;
  Status AddMeasurement(const Measurement& measurement) override;
  [[nodiscard]] NavEstimate Latest() const override { return initial_->Latest(); }
  [[nodiscard]] bool initialized() const override { return initial_->initialized(); }
  [[nodiscard]] const FrameStatistics& last_statistics() const override {
    return initial_->last_statistics();
  }
  [[nodiscard]] std::optional<ClockState> LatestClock() const override { return initial_->LatestClock(); }
  [[nodiscard]] const GnssResiduals* last_gnss() const override { return initial_->last_gnss(); }
  Result<std::vector<FinalizedFrame>> TakeFinalized(const std::atomic<bool>* stop) override;

  [[nodiscard]] const BatchSequence& sequence() const { return sequence_; }

 private:
  /// Appends the frame that the initial estimator has reached, unless it is the newest one.
  Status ReachFrame(const NavEstimate& estimate);
  /// The same before a measurement, where the initial estimator gave it a state of its own. Returns the
  /// samples that lead there from the newest frame; empty at the frame itself.
  Result<std::vector<ImuSample>> ReachMeasurement(TimeNs stamp_ns, double max_interpolation_s);

  EstimatorConfig config_;
  std::unique_ptr<Estimator> initial_;
  ImuBuffer imu_;
  double read_out_span_s_;
  BatchSequence sequence_;
  bool aligned_ = false;
  std::vector<int> accepted_;  ///< index in the sequence of every accepted frame
  std::vector<int> tracks_in_;
};

}  // namespace alidade
