#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/estimator/estimator.h"
#include "core/rig_calibration.h"
#include "eval/run/gnss_feed.h"
#include "eval/run/sensor_run.h"
#include "gnss/alignment/alignment.h"
#include "gnss/alignment/inertial_start.h"

namespace alidade {

/// What a session does with its epochs: before the alignment they go to the aligner (or, without a camera, to
/// the start), after it to the estimator.
class GnssRun final : public SensorRun {
 public:
  /// All but `setup` must outlive the object.
  GnssRun(const EstimatorConfig& config, const RigCalibration& rig, const GnssSetup& setup, double lateness_s,
          Estimator* estimator, std::vector<SessionEvent>* events);

  [[nodiscard]] GnssFeed& feed() { return feed_; }
  /// Precondition: aligned.
  [[nodiscard]] const EnuFrame& enu() const { return *alignment_->enu; }

  /// Takes an epoch in; see MeasurementRun::Add.
  bool Add(std::shared_ptr<const ObservationEpoch> epoch, TimeNs processed_ns);
  [[nodiscard]] std::optional<TimeNs> NextImuTime() override;
  [[nodiscard]] std::size_t waiting() const override { return feed_.size(); }
  void SkipNext() override;
  [[nodiscard]] bool aligned() const override { return alignment_.has_value(); }
  Result<bool> Take(bool running) override;
  /// A frame was taken at `stamp_ns`. Hands the aligner the state there, and the estimator the alignment as
  /// soon as there is one, which is then returned. `gyro_radps`: of that time.
  Result<std::optional<GnssAlignment>> Align(TimeNs stamp_ns, const Eigen::Vector3d& gyro_radps);
  /// The estimator has restarted with a state in the ENU frame.
  Status Realign();
  /// Reports what became of satellites since the last call.
  void CollectResiduals();
  /// The state after a frame; a new start goes on from its clock.
  void Remember(TimeNs stamp_ns, const std::optional<ClockState>& clock);

  // Without a camera.
  void AddImuBeforeStart(const ImuSample& sample) { start_.AddImu(sample); }
  /// Takes an epoch; the start once it is known.
  std::optional<GnssInertialStart::Start> TryStart();
  [[nodiscard]] const std::string& start_report() const { return start_.report(); }
  /// The estimator has begun there.
  Status AlignAtStart(const GnssInertialStart::Start& start);

 private:
  /// The epoch's single-point solution beside the estimate.
  [[nodiscard]] std::optional<AbsoluteComparison> Compare(TimeNs stamp_ns) const;
  void ReportWaiting(TimeNs stamp_ns);
  void ReportAligned(const GnssAlignment& alignment, TimeNs stamp_ns, double yaw_std_rad);

  GnssReceiver receiver_;
  Estimator& estimator_;
  GnssFeed feed_;
  GnssAligner aligner_;
  GnssInertialStart start_;
  std::optional<GnssAlignment> alignment_;  ///< the one in use
  std::string waiting_for_;                 ///< as last reported
  TimeNs residuals_ns_ = INT64_MIN;         ///< of the last ones reported
  Vector6d clock_ = Vector6d::Zero();       ///< after the last frame
  TimeNs clock_ns_ = 0;
};

}  // namespace alidade
