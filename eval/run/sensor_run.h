#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/absolute_monitor.h"
#include "core/estimator/estimator.h"
#include "eval/run/session_event.h"
#include "gnss/alignment/alignment.h"

namespace alidade {

/// What a session does with the messages of one sensor between frames: they wait in the order of IMU time,
/// and go to the estimator once it stands in the world that they need.
class SensorRun {
 public:
  virtual ~SensorRun() = default;

  [[nodiscard]] Sensor sensor() const { return sensor_; }
  /// Of SessionOptions.
  [[nodiscard]] double lateness_s() const { return lateness_s_; }

  /// IMU time of the next message; nothing when none waits.
  [[nodiscard]] virtual std::optional<TimeNs> NextImuTime() = 0;
  [[nodiscard]] virtual std::size_t waiting() const = 0;
  /// Lets the next message go and reports it as skipped: the IMU does not reach it.
  virtual void SkipNext() = 0;

  /// The messages go to the estimator, and need the IMU.
  [[nodiscard]] virtual bool aligned() const = 0;
  /// Takes the next message; `running`: there is an estimate. The IMU reaches the message when the run is
  /// aligned. True when the estimator took it. A Status: the estimator is lost (kDiverged) or takes none of
  /// this sensor (kConfig).
  virtual Result<bool> Take(bool running) = 0;
  /// The message that Take took last beside the estimate that it corrected; nothing where that is not
  /// watched, or the message is no position.
  [[nodiscard]] const std::optional<AbsoluteComparison>& comparison() const { return comparison_; }

 protected:
  /// `events` must outlive the object.
  SensorRun(Sensor sensor, double lateness_s, std::vector<SessionEvent>* events)
      : sensor_(sensor), lateness_s_(lateness_s), events_(*events) {}

  [[nodiscard]] std::vector<SessionEvent>& events() { return events_; }
  void SetComparison(const std::optional<AbsoluteComparison>& comparison) { comparison_ = comparison; }
  /// A message with this stamp was not used.
  void Skip(TimeNs stamp_ns, std::string reason) {
    events_.emplace_back(SkippedEvent{sensor_, stamp_ns, std::move(reason)});
  }
  /// It came too late by `by_ns`.
  void RefuseLate(TimeNs stamp_ns, TimeNs by_ns) {
    events_.emplace_back(TooLateEvent{sensor_, stamp_ns, SecondsBetween(0, by_ns)});
  }

 private:
  const Sensor sensor_;
  const double lateness_s_;
  std::vector<SessionEvent>& events_;
  std::optional<AbsoluteComparison> comparison_;
};

/// A SensorRun of one of SensorEntries.
class MeasurementRun : public SensorRun {
 public:
  using SensorRun::SensorRun;

  /// Takes a measurement in as its sensor gives it. False: it was refused, which is reported; `processed_ns`:
  /// IMU time up to which messages were processed.
  virtual bool Add(const Measurement& measurement, TimeNs processed_ns) = 0;

  /// A frame was taken at `stamp_ns`. A sensor that aligns the run hands the estimator the alignment as soon
  /// as there is one, which is then returned.
  virtual Result<std::optional<GnssAlignment>> Align(TimeNs /*stamp_ns*/) {
    return std::optional<GnssAlignment>();
  }
  /// Another sensor has aligned the run, with this frame.
  virtual void AlignedByAnother(const std::optional<EnuFrame>& enu) = 0;
  /// The estimator has begun anew with a state that stands in the aligned world already. For the sensor that
  /// aligned the run.
  virtual Status Realign() { return Status::Ok(); }
};

}  // namespace alidade
