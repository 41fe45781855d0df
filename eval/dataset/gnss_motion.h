#pragma once

#include <optional>
#include <vector>

#include "eval/dataset/clock_shift.h"
#include "eval/dataset/log_tables.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// How far the course of a receiver has turned between two epochs.
struct CourseChange {
  TimeNs first_ns = 0;  ///< of the receiver's tags
  TimeNs last_ns = 0;
  double turn_rad = 0;  ///< about up, counterclockwise
};

/// Of up to about 150 pairs of epochs a second apart, evenly over the log and without overlap: those in which
/// the Doppler velocity shows the antenna to move, horizontally, at 1 m/s or more with a course known to 0.1
/// rad.
[[nodiscard]] std::vector<CourseChange> CourseChanges(const GnssLog& log);

/// How a receiver's courses and the gyroscope's turns about the vertical agree.
struct CourseAgreement {
  int pairs = 0;
  double correlation = 0;
  double slope = 0;  ///< turns of the body a turn of the course
};

/// What the gyroscope turned about the vertical, to be asked for any interval.
class VerticalTurns {
 public:
  /// The vertical in the body is carried on by the gyroscope and drawn to the specific force in some seconds:
  /// no attitude is needed. Errors: the table's.
  static Result<VerticalTurns> Of(const Table<ImuSample>& imu);

  /// [rad], counterclockwise; none when the IMU does not cover the interval.
  [[nodiscard]] std::optional<double> Between(TimeNs first_ns, TimeNs last_ns) const;
  /// shift_ns: added to the receiver's tags.
  [[nodiscard]] CourseAgreement Compare(const std::vector<CourseChange>& courses, TimeNs shift_ns) const;

 private:
  [[nodiscard]] std::optional<double> At(TimeNs stamp_ns) const;

  std::vector<TimeNs> stamps_;  ///< about ten a second
  std::vector<double> turns_;   ///< since the first
};

/// The known difference of clocks (eval/dataset/clock_shift.h) to be added to the receiver's tags, by which
/// its courses follow the gyroscope (correlation above 0.7 in 30 pairs or more, a turn of the body half to
/// one and a half turns of the course), whereas with `offset_ns` alone they do not (below 0.3). It needs a
/// rig that turns with its course: a vehicle, or a person who walks. Of others nothing is said.
struct CourseShift {
  ClockShift shift;
  CourseAgreement as_given, shifted;
};
[[nodiscard]] std::optional<CourseShift> ShiftByCourse(const std::vector<CourseChange>& courses,
                                                       const VerticalTurns& turns, TimeNs offset_ns);

}  // namespace alidade
