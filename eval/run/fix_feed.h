#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/rig_calibration.h"
#include "gnss/base/geodesy.h"

namespace alidade {

/// Position fixes in the order of IMU time, brought into one frame N: the ENU frame in which the sequence's
/// truth stands (GnssReceiver::anchor_E), else that of the first sensor, which may be a frame of its own.
/// Fixes in a frame that is not related to N are refused.
class FixFeed {
 public:
  /// `with_gnss`: raw GNSS is in use too, and N an ENU frame.
  FixFeed(const RigCalibration& rig, bool with_gnss);

  enum class Arrival {
    kTaken,
    kTwice,      ///< there is one of this sensor and stamp already
    kTooLate,    ///< older than one that was popped
    kUnrelated,  ///< its frame is not related to N
    kNoSensor,   ///< the rig has no such sensor
  };
  /// A fix as its sensor gives it.
  Arrival Add(const PositionFix& fix);

  /// N as far as its place on the Earth is known.
  [[nodiscard]] const std::optional<EnuFrame>& enu() const { return enu_; }
  /// N is this ENU frame, as raw GNSS has found it.
  void SetFrame(const EnuFrame& enu);

  /// The next fix in IMU time and N, or null; valid until the next call.
  const PositionFix* Next();
  /// Its stamp in the sensor's clock. Precondition: there is one.
  [[nodiscard]] TimeNs next_stamp_ns() const { return waiting_.begin()->second.stamp_ns; }
  void Pop();
  [[nodiscard]] bool HasSensor(int sensor) const {
    return sensor >= 0 && static_cast<std::size_t>(sensor) < sensors_.size();
  }
  /// IMU time of a fix. Precondition: the rig has its sensor.
  [[nodiscard]] TimeNs ImuTime(const PositionFix& fix) const {
    return fix.stamp_ns + SecondsToNs(sensors_[static_cast<std::size_t>(fix.sensor)].time_offset_s);
  }
  /// IMU time of the last one popped.
  [[nodiscard]] TimeNs last_ns() const { return last_.first; }
  [[nodiscard]] std::size_t size() const { return waiting_.size(); }

 private:
  [[nodiscard]] bool IsRelated(int sensor) const;

  std::vector<FixSensor> sensors_;
  bool on_earth_;  ///< N is an ENU frame
  std::optional<EnuFrame> enu_;
  std::vector<std::optional<EnuFrame>> frames_;            ///< by sensor
  std::map<std::pair<TimeNs, int>, PositionFix> waiting_;  ///< by IMU time and sensor
  std::pair<TimeNs, int> last_ = {INT64_MIN, 0};
  PositionFix next_;
};

}  // namespace alidade
