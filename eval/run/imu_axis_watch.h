#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "core/imu_sample.h"
#include "eval/run/held_rows.h"
#include "eval/run/implied_imu.h"

namespace alidade {

/// Finds axes of an inertial sensor that do not measure: saturated at the end of their range, or stuck.
///
/// Noise moves every axis, so a value that repeats itself exactly reveals a fault. What counts are
/// measurements in which another axis of the sensor changed: a row that a driver hands out twice is none.
///
/// Saturated: kSaturated measurements in a row have the value that is the largest or smallest of all so far,
/// its magnitude is above the floor, and the axis came from kSteps of its resolution (smallest step so far)
/// away within as many measurements before: the top of a smooth motion is flat over few steps only. Below
/// the floor, and for an axis that has never moved, kSaturatedInDoubt, while another one spans kSpan of the
/// resolution. Afterwards this value alone suffices, until it is exceeded, or until the axis has been within
/// kSteps of it for kConstantS while no other one spans kSpan of its resolution: a coarse accelerometer that
/// is put down quickly comes to rest at such a value. An axis has a lower and an upper limit.
///
/// Stuck: kStuck measurements in a row are equal while both others span kSpan of its resolution: at rest a
/// coarse sensor may repeat itself, and a constant value is no error there. Fewer suffice for an axis that
/// seldom repeats itself, if it came from kSteps away while another one spans kSpan: as many as chance
/// explains with 1e-10, at least kSaturated. An axis that has repeated itself more often than not in the last
/// thousand measurements before does not count as stuck. One that comes back to the value at which it was
/// stuck, from kSteps away and for kReturned measurements, is saturated there: a limit below what the axis
/// measured before. In recordings of five kinds of sensors, faultless ones, no more than 7 in a row are
/// equal.
///
/// Frozen: all axes of a sensor are held (HeldRows), while an axis of the other one spans kSpan, or while the
/// other one is held too, and an axis has changed more often than not. Or they have never moved, which above
/// the floor is no rest, while the other sensor moves.
///
/// A stuck or frozen axis reads what the motion implies (ImpliedImu), where that is not known its mean of the
/// last thousand measurements before. A saturated one reads that where it is beyond the limit. The error of
/// the axis is taken as constant with the deviation sigma for kConstantS, and as white noise of that
/// correlation time afterwards: N^2 = 2 sigma^2 min(t, kConstantS), t since the first equal sample; the
/// step that detects gets the variance sigma^2 t^2 up to then. Stuck: sigma^2 is the variance about the
/// mean, in the step that detects about the stuck value. Saturated: the motion goes on as it came, at most
/// half beyond the range: sigma = min(rate t, |value| / 2), |value| / 2 if that is not known. Both at least
/// the floor, 0.2 rad/s and 1 m/s^2 (core/imu_gap.h), or |value| of a saturated axis where that is less. The
/// noise of a stuck axis is in its direction alone. That of a saturated one, or of one that is stuck at its
/// largest or smallest value, is in all three: in a motion beyond the range the other axes may be clipped in
/// samples that do not reveal it yet.
///
/// Neglected: axes that a calibration has mixed, since none of them repeats itself; an axis that sticks in
/// the first kLeastMeasurements.
class ImuAxisWatch {
 public:
  static constexpr int kSaturated = 5;
  static constexpr int kSaturatedInDoubt = 10;
  static constexpr int kStuck = 20;
  static constexpr int kReturned = 3;
  static constexpr double kSteps = 20;
  static constexpr double kSpan = 10;
  static constexpr int kLeastMeasurements = 100;
  static constexpr double kConstantS = 1;
  /// A fault that returns within this time is the same one.
  static constexpr double kSameFaultS = 10;

  /// implied: may be null; must outlive the object.
  explicit ImuAxisWatch(const ImpliedImu* implied = nullptr);

  /// The next sample in order; sets the noise of its fault and replaces a stuck axis. Returns what is wrong,
  /// unless it was reported before; else nothing.
  std::string Add(ImuSample* sample);
  /// What is wrong with the last sample; empty: nothing.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  struct Level {
    double value = 0;
    TimeNs since_ns = 0;
  };
  struct Axis {
    // Of the measurements with the newest value.
    std::int64_t equal = 1;
    TimeNs since_ns = 0;
    std::array<double, 2> low{}, high{};  ///< of the other axes meanwhile
    double came_from = 0;                 ///< farthest of the kSaturated measurements before
    double came_from_s = 0;               ///< how long before the first of them; 0: not known
    bool faulty = false;
    // Of all.
    std::deque<std::pair<TimeNs, double>> recent;  ///< the last kSaturated measurements
    std::int64_t measured = 0;
    double resolution = 0;  ///< 0: not known
    double lowest = 0, highest = 0;
    // Below and above zero.
    std::array<std::optional<Level>, 2> limits;    ///< since: it has been within kSteps of the limit
    std::array<std::optional<Level>, 2> stuck_at;  ///< last; since: the first of the equal measurements
    // Of the last thousand before the newest value's repetitions, weighted exponentially.
    double counted = 0;
    double changed = 0;  ///< of those
    double mean = 0, mean_square = 0;
    TimeNs reported_until_ns = INT64_MIN;
  };
  struct Signal {
    Eigen::Vector3d ImuSample::*value;
    Eigen::Vector3d ImuSample::*fault_density;
    std::optional<double> (ImpliedImu::*implied)(int axis, TimeNs stamp_ns) const;
    const char* name;
    const char* unit;
    double floor;
    std::array<Axis, 3> axes{};
    HeldRows held{};
  };
  enum class Fault { kNone, kSaturated, kStuck, kFrozen };

  static void Begin(const ImuSample& sample, const Signal& other, Signal* signal);
  /// Adds the repetitions of the last value and the first measurement of the next one to what came before.
  static void CountShare(bool changed, Axis* axis);
  /// While the axis has its newest value.
  [[nodiscard]] static bool OthersMove(const Axis& axis, double resolution);
  /// Of an axis; as long as it has not moved, the smaller one of the others; 0: not known.
  [[nodiscard]] static double Resolution(const Signal& signal, int index);
  /// Lets go of a limit that the values exceed, or stay close to for too long without a change.
  static void CheckLimits(double value, TimeNs stamp_ns, Axis* axis);
  static void Count(const Signal& signal, int index, const ImuSample& last, const ImuSample& sample,
                    Axis* axis);
  /// Changes more often than it repeats itself.
  [[nodiscard]] static bool IsRestless(const Axis& axis);
  /// Of all measurements so far.
  [[nodiscard]] static bool IsExtreme(double value, const Axis& axis);
  /// Equal measurements in a row that noise does not explain, by how often the axis has repeated itself.
  [[nodiscard]] static int StuckRun(const Axis& axis);
  [[nodiscard]] static Fault Classify(double value, double floor, double resolution, const Axis& axis);
  [[nodiscard]] static double Sigma(Fault fault, double value, double floor, double seconds,
                                    const Axis& axis);
  /// What a faulty axis is taken to read.
  [[nodiscard]] double Reading(Fault fault, double value, const Axis& axis,
                               std::optional<double> implied) const;
  /// Of a sensor: rows in which none of its axes changes.
  static void CountHeld(const ImuSample& last, const ImuSample& sample, const Signal& other, Signal* signal);
  /// What is wrong with one axis, if it is to be reported.
  std::string AddAxis(const ImuSample& last, const ImuSample& measured, int index, Signal* signal,
                      ImuSample* sample);

  const ImpliedImu* implied_;
  std::array<Signal, 2> signals_;
  bool any_ = false;
  ImuSample last_;
  std::string reason_;
};

}  // namespace alidade
