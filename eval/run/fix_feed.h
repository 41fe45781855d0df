#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/measurement_log.h"
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
  void Pop();
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
