#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "eval/run/camera_clock.h"
#include "eval/run/estimator_loop.h"
#include "eval/run/imu_clock.h"
#include "eval/run/imu_leap.h"
#include "eval/run/session_event.h"
#include "eval/run/session_options.h"

namespace alidade {

/// The state at the newest IMU sample, for control: the last estimate carried on over the IMU.
struct NewestState {
  NavEstimate estimate;  ///< in the world the estimates stand in; covariance in the canonical chart
  Eigen::Vector3d v_B = Eigen::Vector3d::Zero();      ///< velocity of the body in its own axes [m/s]
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< angular rate, bias removed [rad/s]
};

/// An estimator for a robot: takes the messages of its sensors as they arrive, and reports what it makes of
/// them as events.
///
/// Messages of each sensor and between sensors may come in any order within SessionOptions::lateness; they
/// are processed in the order of their IMU time (camera stamp + time offset; receiver's tag - receiver clock
/// + offset; another measurement's stamp + its sensor's offset), those of the same time in the order of
/// frame, epoch and SensorEntries. In time means: when the message is added, the newest IMU stamp is less
/// than the sensor's lateness ahead of its IMU time. The same messages in whatever order in time give the
/// same estimates, bit by bit. A later one is used while nothing newer was processed, else refused with a
/// TooLateEvent. Stamps of a sensor are unique: a second message of one stamp is skipped.
///
/// The session starts by itself (init.method), checks its estimate, seeks a new start when it is lost, and
/// aligns with GNSS or position fixes. A bad message is reported as skipped; nothing of it aborts. Memory is
/// bounded by the estimator's window, the lateness and SessionOptions::max_silence_s and max_waiting. Not
/// thread-safe.
class Session {
 public:
  /// With the back end that `config` names. kConfig: the configuration contradicts itself, or init.method is
  /// truth without SessionOptions::start_state.
  static Result<std::unique_ptr<Session>> Make(const EstimatorConfig& config, const RigCalibration& rig,
                                               SessionOptions options = {});
  /// With an estimator that outlives the session and takes part in nothing else meanwhile.
  Session(const EstimatorConfig& config, const RigCalibration& rig, SessionOptions options,
          Estimator* estimator);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// In a live session a sample more than ImuLeap::kMaxLeapS after the newest one is held until the next
  /// confirms it, else skipped.
  void AddImu(const ImuSample& as_stamped);
  /// Tracks of one image; stamp in camera time.
  void AddFrame(TrackFrame frame);
  /// Raw observations of one receiver epoch; stamp: the receiver's tag.
  void AddGnss(ObservationEpoch epoch);
  void AddGnss(std::shared_ptr<const ObservationEpoch> epoch);
  /// A position fix (core/position_fix.h); stamp and frame of its sensor.
  void AddFix(const PositionFix& fix) { AddMeasurement(fix); }
  /// A measurement of any of SensorEntries (core/estimator/measurement.h), likewise.
  void AddMeasurement(const Measurement& measurement);
  /// Ephemerides for the epochs with tags from `from_tag_ns` on; the newest such catalog is the one in use.
  /// To be added before those epochs.
  void AddCatalog(TimeNs from_tag_ns, std::shared_ptr<const SatelliteCatalog> catalog);

  /// No message with an IMU time before `imu_ns` is awaited any more: all that waits up to there is
  /// processed, but for what lies after a silence of the IMU that may be a jump of its clock (ImuClock). That
  /// waits until frames decide, for ImuClock::kDoubtS beyond the silence at most.
  void AdvanceTo(TimeNs imu_ns);
  /// Processes all that waits: at the end of a log.
  void Flush() { AdvanceTo(INT64_MAX); }

  /// No frame comes any more: what waits for one that decides about a silence of the IMU is processed.
  void EndDoubt();

  /// What happened since the last call, in order.
  [[nodiscard]] std::vector<SessionEvent> TakeEvents();
  /// The estimator is not disturbed. kDiverged: there is no estimate now.
  [[nodiscard]] Result<NewestState> Newest();

  /// IMU time of a camera stamp as the driver gives it, as far as the time offset is known now.
  [[nodiscard]] TimeNs ImuTime(TimeNs camera_ns) const { return loop_.ImuTime(camera_ns - camera_jump_ns_); }
  /// By how much the IMU's clock has jumped, as far as was found: it is taken off the stamps of samples as
  /// they are added.
  [[nodiscard]] TimeNs imu_jump_ns() const { return imu_jump_ns_; }
  [[nodiscard]] bool running() const { return loop_.running(); }
  /// After a FailedEvent; messages are then ignored.
  [[nodiscard]] bool failed() const { return loop_.failed(); }
  /// Samples, frames, epochs and other measurements that are held.
  [[nodiscard]] size_t held();

 private:
  /// A message whose turn it is.
  struct Due {
    SensorRun* sensor = nullptr;  ///< null: a frame
    TimeNs imu_ns = INT64_MAX;
  };

  /// Takes a sample in, in order.
  void TakeImu(const ImuSample& sample);
  /// Takes a sample of a live session in, unless it leaps.
  void TakeUnlessLeap(const ImuSample& sample);
  void Process();
  /// A message of this sensor has been taken in.
  void ProcessAfter(SensorRun* arrival);
  /// A message of a sensor that the session is without.
  void SkipUnused(Sensor sensor, TimeNs stamp_ns, const char* name);
  [[nodiscard]] Due NextDue();
  [[nodiscard]] bool IsReady(const Due& due);
  /// How far beyond it the IMU is needed [ns].
  [[nodiscard]] TimeNs LeadOf(const Due& due) const;
  /// The IMU reaches `imu_ns`, and no sample before that is awaited.
  [[nodiscard]] bool ImuReaches(TimeNs imu_ns);
  /// Before it the IMU was silent, and may have jumped instead.
  bool IsInDoubt(const Due& due);
  /// Compares the frames that wait with the gyroscope, as far as both are complete.
  void DecideOnSilence();
  /// The IMU's clock has jumped by the silence in question.
  void TakeBackImuJump();
  /// No message before this IMU time is awaited.
  [[nodiscard]] TimeNs Watermark();
  void ProcessNext(SensorRun* sensor);
  void ProcessNextFrame();
  /// As far as it is known [rad/s].
  [[nodiscard]] Eigen::Vector3d GyroBias() const;
  /// The camera's clock has jumped: this frame and all that wait lie earlier by `jump_ns`.
  void TakeBackJump(TimeNs jump_ns, TrackFrame* frame);
  void ProcessNextEpoch();
  void Skip(Sensor sensor, TimeNs stamp_ns, std::string reason);
  void SkipTwice(Sensor sensor, TimeNs stamp_ns);
  void RefuseLate(Sensor sensor, TimeNs stamp_ns, TimeNs by_ns);

  const EstimatorConfig config_;
  const RigCalibration rig_;
  const SessionOptions options_;
  std::unique_ptr<Estimator> own_estimator_;
  std::vector<SessionEvent> events_;
  EstimatorLoop loop_;
  CameraClock camera_clock_;
  ImuClock imu_clock_;
  TimeNs imu_jump_ns_ = 0;               ///< by which the IMU's stamps are off
  ImuLeap leap_;                         ///< in a live session
  TimeNs camera_jump_ns_ = 0;            ///< by which the camera's stamps are off
  std::map<TimeNs, TrackFrame> frames_;  ///< waiting, by camera stamp less the jump
  TimeNs frame_offset_ns_;               ///< IMU time less camera time after the last frame
  TimeNs last_frame_ns_ = INT64_MIN;     ///< camera stamp of the last processed frame
  TimeNs processed_ns_ = INT64_MIN;      ///< IMU time up to which messages were processed
  TimeNs advanced_ns_ = INT64_MIN;       ///< by AdvanceTo
};

}  // namespace alidade
