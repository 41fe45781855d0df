#pragma once

#include <optional>
#include <string>
#include <variant>

#include "core/estimator/estimator.h"
#include "eval/run/degradation_kind.h"
#include "gnss/alignment/alignment.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

// What a Session reports. Stamps of messages are those of their sensor: camera time and IMU time (less the
// jumps of their clocks that were found), receiver's tag. Stamps of estimates are IMU time.

/// The first state was found. The StateEvent of the frame that gave it follows.
struct StartedEvent {
  NavEstimate estimate;
  std::string method;  ///< given | static | dynamic | gnss
  std::string report;  ///< the figures that let it pass
};

/// The state after a frame, an epoch or another measurement that the estimator took.
struct StateEvent {
  Sensor source = Sensor::kCamera;
  TimeNs message_ns = 0;  ///< stamp of the frame; IMU time of another message
  /// A smoother may keep what comes between frames for its next frame: then the state is still that of the
  /// last one.
  NavEstimate estimate;
  FrameStatistics statistics;                      ///< of this message
  std::optional<ClockState> clock;                 ///< once aligned with GNSS
  std::optional<CalibrationEstimate> calibration;  ///< of an estimator that calibrates online
  double frontend_ms = 0;                          ///< TrackFrame::frontend_ms
  double backend_ms = 0;  ///< wall time for this message and the IMU samples before it
};

/// The statistics of a message between frames, without those of vision, which a smoother's solve adds.
[[nodiscard]] FrameStatistics BetweenFrames(const FrameStatistics& all);

/// Most of the newest frame's tracks contradict the state (FrameStatistics::suspect); follows its StateEvent.
struct SuspectEvent {
  TimeNs stamp_ns = 0;  ///< of the state
  std::string reason;
};

/// The estimate goes on without what it needs (Degradation): its covariance grows. Follows the StateEvent of
/// every such frame.
struct DegradedEvent {
  TimeNs stamp_ns = 0;  ///< of the state
  std::string reason;
  DegradationKind kind = DegradationKind::kData;
};

/// The estimate was given up; a new start is sought.
struct LostEvent {
  TimeNs stamp_ns = 0;  ///< IMU time of the message at which it was
  std::string reason;
};

/// A new start was found, placed where dead reckoning from the last sound state leads.
struct RestartedEvent {
  TimeNs lost_ns = 0;  ///< stamp of the LostEvent
  NavEstimate estimate;
  std::string method;
  std::string report;
};

/// How the estimates came to stand in the ENU frame, or in the frame of a position sensor.
struct GlobalFrame {
  std::optional<EnuFrame> enu;                     ///< nothing: a frame whose place on the Earth is not known
  Sensor source = Sensor::kGnss;                   ///< whose measurements the alignment was estimated from
  Eigen::Vector3d p_BA = Eigen::Vector3d::Zero();  ///< of GNSS
  TimeNs stamp_ns = 0;                             ///< of the first state that stands there
  double time_offset_s = 0;                        ///< IMU time less GPST, as given or estimated; of GNSS
  double yaw_rad = 0;                              ///< by which the local world was turned
  double yaw_std_rad = 0;
};

/// The local world was turned into the ENU frame or that of a position sensor: estimates from now on stand
/// there; TurnIntoEnu with `alignment` turns earlier ones.
struct AlignedEvent {
  GlobalFrame global;
  GnssAlignment alignment;
  NavEstimate estimate;  ///< the state of the last StateEvent, turned
  std::optional<ClockState> clock;
};

/// What became of the satellites of an epoch. A smoother gates them with the frame after the epoch.
struct SatellitesEvent {
  GnssResiduals residuals;
};

/// What is still sought, and why it was not found yet.
enum class Sought { kStart, kRestart, kAlignment };
struct WaitingEvent {
  Sought sought = Sought::kStart;
  TimeNs stamp_ns = 0;  ///< of the frame or epoch at which it was sought
  std::string reason;
};

/// A message was refused because newer ones had been processed when it came.
struct TooLateEvent {
  Sensor sensor = Sensor::kImu;
  TimeNs stamp_ns = 0;
  double late_s = 0;  ///< by which its IMU time lies before what was processed
};

/// A message was not used.
struct SkippedEvent {
  Sensor sensor = Sensor::kImu;
  TimeNs stamp_ns = 0;
  std::string reason;
};

/// The session is over: the estimate is lost and no new start may be sought (recovery.enabled, a back end
/// that looks back, GNSS without a camera), or the back end refused its start or its alignment.
struct FailedEvent {
  TimeNs stamp_ns = 0;  ///< IMU time of the message at which it was
  Status status;
};

using SessionEvent =
    std::variant<StartedEvent, StateEvent, SuspectEvent, DegradedEvent, LostEvent, RestartedEvent,
                 AlignedEvent, SatellitesEvent, WaitingEvent, TooLateEvent, SkippedEvent, FailedEvent>;

/// One line for a log or a terminal: "lost at 12.300 s: speed 130 m/s, limit 100".
[[nodiscard]] std::string Describe(const SessionEvent& event);

}  // namespace alidade
