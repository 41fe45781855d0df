#pragma once

#include "core/estimator/estimator.h"
#include "core/estimator/measurement_log.h"
#include "eval/dataset/log_tables.h"
#include "eval/record/run_builder.h"
#include "eval/record/run_options.h"
#include "eval/run/session.h"

namespace alidade {

/// One pass of one estimator over one log, as described at RunEstimator: hands the log to a session. All
/// arguments must outlive it.
class LogPlayer {
 public:
  /// `tables` are those of the log; its own vectors of them are not read.
  LogPlayer(const EstimatorConfig& config, const MeasurementLog& log, const LogTables& tables,
            const RunOptions& options, Estimator* estimator);

  /// To be called once.
  RunResult Play();

 private:
  [[nodiscard]] SessionOptions OptionsOfSession() const;
  [[nodiscard]] Result<NavEstimate> FirstState(TimeNs imu_ns) const;
  /// Why init.method truth cannot start this run whatever the frame.
  [[nodiscard]] Status CheckTruth() const;
  void PlayFrames();
  /// False: the run is over.
  bool PlayFrame(const TrackFrame& frame);
  /// GNSS and IMU without a camera.
  void PlayEpochs();
  /// Every sample up to and including the first one at or after `stamp_ns`.
  void AddImuUntil(TimeNs stamp_ns);
  /// Every epoch with a tag before `imu_ns` in IMU time.
  void AddEpochsUntil(TimeNs imu_ns);
  void AddEpoch(size_t index);
  /// What all of SensorEntries measured at an IMU time before `imu_ns`.
  void AddMeasurementsUntil(TimeNs imu_ns);
  void TakeEvents();
  [[nodiscard]] bool Stopped() const { return options_.stop != nullptr && options_.stop->load(); }
  /// What the status becomes when the log is at its end.
  void Conclude();
  void TakeFinalized();
  void CompareCalibration();

  const EstimatorConfig& config_;
  const MeasurementLog& log_;
  const LogTables& tables_;
  const RunOptions& options_;
  Estimator& estimator_;
  const bool camera_;  ///< else there are epochs alone
  Session session_;
  RunBuilder builder_;
  RunResult& result_;
  Table<ImuSample>::Pass imu_;
  TimeNs last_frame_ns_ = INT64_MIN;  ///< IMU time of the last frame handed over
  TimeNs last_imu_ns_ = INT64_MIN;    ///< handed over
  size_t next_epoch_ = 0;
  PerSensor<size_t> next_measurement_;
};

}  // namespace alidade
