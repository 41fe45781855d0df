#pragma once

#include <optional>
#include <string>

#include "core/stopwatch.h"
#include "eval/run/gnss_run.h"
#include "eval/run/recovery.h"
#include "eval/run/run_start.h"
#include "eval/run/runner.h"

namespace alidade {

/// One pass of one estimator over one log, as RunEstimator says. All arguments must outlive it.
class EstimatorRun {
 public:
  EstimatorRun(const EstimatorConfig& config, const MeasurementLog& log, const RunOptions& options,
               Estimator* estimator);

  /// To be called once.
  RunResult Execute();

 private:
  [[nodiscard]] TimeNs ImuStamp(const TrackFrame& frame) const;
  void ProcessFrame(const TrackFrame& frame);
  /// GNSS epochs with an IMU time before `stamp_ns`; the IMU reaches that far.
  void ProcessEpochsBefore(TimeNs stamp_ns);
  /// GNSS and IMU without a camera: a record an epoch.
  void ProcessEpochsAlone();
  void StartWithEpoch();
  /// Every sample up to and including the first one at or after `stamp_ns`.
  void DeliverImu(TimeNs stamp_ns);
  void AddImu(const ImuSample& sample);
  void TryInitialize(const TrackFrame& frame);
  void TryRestart(const TrackFrame& frame);
  /// The estimate is lost: the run ends unless a new start may be sought.
  void GiveUp(TimeNs stamp_ns, Status status);
  void Begin(const NavEstimate& start);
  void AddFrame(const TrackFrame& frame, const Stopwatch& stopwatch);
  /// A row of the run: the estimator's state after the frame or epoch at `stamp_ns`.
  void RecordState(TimeNs stamp_ns, const Stopwatch& stopwatch);
  void Finalize();
  void CompareCalibration();
  [[nodiscard]] std::string Reason() const;

  const EstimatorConfig& config_;
  const MeasurementLog& log_;
  const RunOptions& options_;
  Estimator& estimator_;
  RunResult result_;
  RunStart start_;
  Recovery recovery_;
  std::optional<GnssRun> gnss_;
  size_t next_imu_ = 0;
  bool initialized_ = false;
  bool restarted_ = false;  ///< the next record is the first of a new start
};

}  // namespace alidade
