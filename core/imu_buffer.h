#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/imu_sample.h"
#include "core/status.h"

namespace alidade {

/// Counts of what an ImuBuffer had to mend; reported in the run's statistics.
struct ImuBufferStatistics {
  int accepted = 0;
  int duplicates = 0;    ///< same stamp twice; the first is kept
  int out_of_order = 0;  ///< arrived late and sorted in
  int rejected = 0;      ///< not finite, beyond any sensor, or older than what was already consumed
  int gaps = 0;          ///< silences longer than the limit inside a consumed interval
  double longest_gap_s = 0;
};

/// Magnitudes beyond any inertial sensor (the fastest gyroscopes measure 2e3 rad/s, shock accelerometers 2e6
/// m/s^2): such a sample is a fault of the transmission or of the units.
constexpr double kMaxGyroRadps = 1e4;
constexpr double kMaxAccelMps2 = 1e7;

/// Inertial samples sorted by stamp, cut to the intervals that measurements ask for.
class ImuBuffer {
 public:
  explicit ImuBuffer(double max_gap_s) : max_gap_s_(max_gap_s) {}

  /// Sorts the sample in. kInput: a component is not finite, a magnitude is beyond any sensor, or the sample
  /// is older than the last consumed interval.
  Status Add(const ImuSample& sample);

  /// Samples that cover [from, to]: interpolated at both ends, all measured ones between, with the curvatures
  /// that earlier samples determine (core/imu_step.h). kInput: to <= from, or the buffer does not reach both
  /// ends (the message gives the missing milliseconds). A gap longer than the limit is counted and bridged by
  /// a line.
  Status Interval(TimeNs from_ns, TimeNs to_ns, std::vector<ImuSample>* interval);

  /// Forgets samples that no interval starting at or after `stamp_ns` needs, but for those of the `kept_s`
  /// seconds before it, which remain in samples().
  void DropBefore(TimeNs stamp_ns, double kept_s = 0);
  /// Begins at a state of this stamp: as DropBefore, but samples of any age are taken from now on. When those
  /// held end more than a silence (core/imu_gap.h) earlier, they are of before a loss and all forgotten.
  void StartAt(TimeNs stamp_ns, double kept_s = 0);
  void Clear() {
    samples_.clear();
    begin_ = 0;
  }

  /// Valid until the next call.
  [[nodiscard]] std::span<const ImuSample> samples() const { return std::span(samples_).subspan(begin_); }
  [[nodiscard]] const ImuBufferStatistics& statistics() const { return statistics_; }

 private:
  double max_gap_s_;
  TimeNs consumed_before_ns_ = INT64_MIN;
  std::vector<ImuSample> samples_;  ///< those before begin_ are forgotten
  size_t begin_ = 0;
  ImuBufferStatistics statistics_;
};

/// At `stamp_ns` between two samples, a.stamp_ns < b.stamp_ns, on the parabola through a and b with b's
/// curvature.
[[nodiscard]] ImuSample Interpolate(const ImuSample& a, const ImuSample& b, TimeNs stamp_ns);

}  // namespace alidade
