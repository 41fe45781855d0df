#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "eval/run/degradation.h"
#include "eval/run/imu_stream.h"
#include "eval/run/recovery.h"
#include "eval/run/sensor_runs.h"
#include "eval/run/session_options.h"

namespace alidade {

/// Drives one estimator over messages that come in the order of their IMU time: finds the first state, hands
/// over IMU, frames, epochs and other measurements, checks the state, and after a loss finds a new start.
/// Reports all of it as events.
class EstimatorLoop {
 public:
  /// All must outlive the object.
  EstimatorLoop(const EstimatorConfig& config, const RigCalibration& rig, const SessionOptions& options,
                Estimator* estimator, std::vector<SessionEvent>* events);
  EstimatorLoop(const EstimatorLoop&) = delete;
  EstimatorLoop& operator=(const EstimatorLoop&) = delete;

  [[nodiscard]] ImuStream& imu() { return imu_; }
  // As in SensorRuns.
  [[nodiscard]] GnssRun* gnss() { return sensors_.gnss(); }
  [[nodiscard]] MeasurementRun* measurements(Sensor sensor) { return sensors_.measurements(sensor); }
  [[nodiscard]] const std::vector<SensorRun*>& sensors() const { return sensors_.all(); }

  /// IMU time of a camera stamp, as far as the time offset is known now.
  [[nodiscard]] TimeNs ImuTime(TimeNs camera_ns) const;
  /// How far beyond an epoch the IMU is needed [ns].
  [[nodiscard]] TimeNs EpochLead() const;
  /// How far beyond a frame: with a rolling shutter until its last row, once the estimator runs.
  [[nodiscard]] TimeNs FrameLead() const { return running() ? read_out_span_ns_ : 0; }

  /// The stamps of "camera" or "IMU" had jumped, and were taken back.
  void OnClockJump(const char* whose, double jump_s) { degradation_.OnClockJump(whose, jump_s); }
  /// The IMU that there is reaches the message; what it lacks is the estimator's to refuse.
  void ProcessFrame(const TrackFrame& frame);
  /// The next one of gnss().
  void ProcessEpoch();
  /// The next message of one of sensors(), which has one.
  void ProcessMessage(SensorRun* sensor);
  /// No message before `now_ns` will come: an estimate that is too old is given up, and IMU samples that no
  /// start will look back to are let go.
  void PassTime(TimeNs now_ns);
  [[nodiscard]] const Estimator& estimator() const { return estimator_; }
  /// Stamp of the newest state.
  [[nodiscard]] TimeNs state_ns() const { return state_ns_; }

  [[nodiscard]] bool running() const { return phase_ == Phase::kRunning; }
  [[nodiscard]] bool failed() const { return phase_ == Phase::kFailed; }

 private:
  enum class Phase { kSeeking, kRunning, kLost, kFailed };

  void ProcessTracks(const TrackFrame& frame, const Stopwatch& stopwatch);
  void ProcessEpochAlone();
  /// A message of the sensor was taken.
  void WatchSensor(const SensorRun& sensor) {
    if (sensor.comparison()) {
      degradation_.OnAbsolute(sensor.sensor(), *sensor.comparison());
    }
  }
  /// Samples up to the first one at or after `stamp_ns`.
  void DeliverImu(TimeNs stamp_ns);
  void AddImu(const ImuSample& sample);
  void TryStart(const TrackFrame& frame);
  Result<NavEstimate> FindStart(const TrackFrame& frame);
  void TryRestart(const TrackFrame& frame);
  void StartWithEpoch();
  /// False: the estimator refused the state and the session is over.
  bool Begin(const NavEstimate& start);
  void AddFrame(const TrackFrame& frame, const Stopwatch& stopwatch);
  void ReportDegraded(TimeNs imu_ns);
  void AlignAfterFrame(TimeNs stamp_ns);
  void ReportState(Sensor source, TimeNs message_ns, double frontend_ms, const Stopwatch& stopwatch);
  void GiveUp(TimeNs stamp_ns, const Status& status);
  void Fail(TimeNs stamp_ns, Status status);
  void TrimImu();

  const EstimatorConfig& config_;
  const RigCalibration& rig_;
  const SessionOptions& options_;
  const TimeNs read_out_span_ns_;
  Estimator& estimator_;
  std::vector<SessionEvent>& events_;
  ImpliedImu implied_;
  ImuStream imu_;
  std::unique_ptr<Initializer> initializer_;  ///< until the first start
  Recovery recovery_;
  Degradation degradation_;
  SensorRuns sensors_;
  Phase phase_ = Phase::kSeeking;
  Eigen::Vector3d gyro_radps_ = Eigen::Vector3d::Zero();  ///< of the last delivered sample
  TimeNs state_ns_ = 0;                                   ///< of the newest state
};

}  // namespace alidade
