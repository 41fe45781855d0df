#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/absolute_monitor.h"
#include "core/calibration_watch.h"
#include "core/estimator/estimator.h"
#include "core/track_frame.h"
#include "eval/run/degradation_kind.h"

namespace alidade {

/// Who measures positions: the kind of the sensor, and which of those the rig has.
using AbsoluteSource = std::pair<Sensor, int>;

/// Detects when an estimate goes on without what it needs, though nothing contradicts it: frames without
/// tracks, images that do not change, an IMU that was silent or has an axis that does not measure; or with a
/// model that does not hold: a camera that is not as given, innovations larger than predicted for long.
class Degradation {
 public:
  struct Verdict {
    std::string reason;  ///< why the estimate is degraded; empty: it is not
    DegradationKind kind = DegradationKind::kData;
  };

  /// Without tracks for this long the estimate is dead reckoning.
  static constexpr double kMaxBlindS = 0.15;
  static constexpr double kMaxFrozenS = 0.25;
  /// After a silence of the IMU.
  static constexpr double kSettlingS = 0.5;
  /// Fewer equal pixels may be chance.
  static constexpr size_t kMinFrozen = 8;
  /// Sum of normalised innovations squared over the sum of their degrees of freedom, one in the mean where
  /// noise and calibration are right. Older frames count less, with this time constant. Wrong tracks do not
  /// raise it: the gates refuse them.
  static constexpr double kMaxInnovations = 1.05;
  static constexpr double kInnovationsS = 10;
  /// No parameter that is as given exceeds the first by chance; one that is not, but hardly moves the pose,
  /// does no harm (core/calibration_watch.h).
  static constexpr double kMaxDoubtSigmas = 5;
  static constexpr double kMaxPoseSigmas = 2;
  /// A pull of GNSS looks like a wrong parameter before its own monitor is sure: so much of it is mentioned.
  static constexpr double kHintSigmas = 2.5;

  /// A measured position beside the estimate, in order of time.
  void OnAbsolute(Sensor sensor, const AbsoluteComparison& comparison);
  /// Why measured positions contradict the rest, which is `by`; empty: they do not.
  [[nodiscard]] std::string AgainstSensors(const char* by) const;
  /// The clock of the camera or the IMU has jumped before the next frame. `whose`: "camera" or "IMU".
  void OnClockJump(const char* whose, double jump_s) {
    jumped_ = whose;
    jump_s_ = jump_s;
    jump_until_ns_ = INT64_MAX;
  }
  /// Every sample that is delivered, in order. `doubt`: what is wrong with it, empty: nothing.
  /// `unit_changed_ns`: when the gyroscope changed its unit last, and is converted from there on.
  void OnImu(TimeNs stamp_ns, const std::string& doubt = {},
             std::optional<TimeNs> unit_changed_ns = std::nullopt);
  /// Whether the frame shows what the one before showed: every track of both, at least kMinFrozen, on the
  /// very same pixel. A sensor's noise moves each of them even at rest: it is the old image under a new
  /// stamp, and carries no information. Every frame, in order.
  bool IsFrozen(const TrackFrame& frame);
  /// Whether tracks may be followed across a frame at `imu_ns` that is frozen: up to kMaxFrozenS after the
  /// last frame with tracks. What a front end finds again after a longer motion is rather another point.
  [[nodiscard]] bool TracksGoOn(TimeNs imu_ns) const;
  /// Whether the estimate after a frame at `imu_ns` is degraded; by data rather than by the model when both
  /// hold. Every frame, in order, after IsFrozen of it.
  /// `doubt`: of a watched calibration, else null.
  [[nodiscard]] Verdict Check(TimeNs imu_ns, const FrameStatistics& statistics,
                              const CalibrationDoubt* doubt = nullptr);
  /// After a start.
  void Reset() {
    sighted_ns_ = INT64_MIN;
    nis_ = dof_ = 0;
    absolute_.clear();
  }

 private:
  // Reasons; empty: there is none.
  [[nodiscard]] std::string FaultOfData(TimeNs imu_ns) const;
  /// `innovations`: LargeInnovations.
  [[nodiscard]] std::string DoubtOfModel(const std::optional<double>& innovations,
                                         const CalibrationDoubt* doubt) const;
  /// Who may contradict, where the monitors are not sure; else empty.
  [[nodiscard]] std::string AbsoluteHint() const;
  /// The mean of kInnovationsS where it is larger than chance makes it, else nothing.
  std::optional<double> LargeInnovations(TimeNs imu_ns, const FrameStatistics& statistics);

  std::map<AbsoluteSource, AbsoluteMonitor> absolute_;
  TimeNs last_imu_ns_ = INT64_MIN;
  TimeNs silent_until_ns_ = INT64_MIN;
  double silence_s_ = 0;
  TimeNs unit_until_ns_ = INT64_MIN;
  TimeNs doubtful_until_ns_ = INT64_MIN;
  std::string doubt_;  ///< of the IMU, until then
  TimeNs jump_until_ns_ = INT64_MIN;
  const char* jumped_ = "";
  double jump_s_ = 0;
  TimeNs sighted_ns_ = INT64_MIN;  ///< the last frame with tracks
  std::vector<TrackObservation> shown_;
  bool frozen_ = false;
  TimeNs weighed_ns_ = 0;
  double nis_ = 0;
  double dof_ = 0;
};

}  // namespace alidade
