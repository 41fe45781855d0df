#include "core/imu_buffer.h"

#include <algorithm>
#include <string>

#include "core/check.h"
#include "core/format.h"
#include "core/imu_gap.h"
#include "core/imu_step.h"

namespace alidade {
namespace {

bool Earlier(const ImuSample& sample, TimeNs stamp_ns) {
  return sample.stamp_ns < stamp_ns;
}

std::string Milliseconds(TimeNs duration_ns) {
  return std::to_string(static_cast<double>(duration_ns) * 1e-6) + " ms";
}

}  // namespace

ImuSample Interpolate(const ImuSample& a, const ImuSample& b, TimeNs stamp_ns) {
  DCHECK_LT(a.stamp_ns, b.stamp_ns);
  const double gap_s = SecondsBetween(a.stamp_ns, b.stamp_ns);
  const double w = SecondsBetween(a.stamp_ns, stamp_ns) / gap_s;
  const double bow = 0.5 * w * (1 - w) * gap_s * gap_s;
  return {stamp_ns,
          (1 - w) * a.gyro + w * b.gyro - bow * b.gyro_curvature,
          (1 - w) * a.accel + w * b.accel - bow * b.accel_curvature,
          gap_s,
          b.gyro_curvature,
          b.accel_curvature,
          b.gyro_fault_density_radps_sqrthz,
          b.accel_fault_density_mps2_sqrthz};
}

Status ImuBuffer::Add(const ImuSample& sample) {
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    ++statistics_.rejected;
    return Status::Input("imu sample at " + FormatSeconds(sample.stamp_ns) + " s is not finite");
  }
  const double rate = sample.gyro.stableNorm();
  const double force = sample.accel.stableNorm();
  if (rate > kMaxGyroRadps || force > kMaxAccelMps2) {
    ++statistics_.rejected;
    return Status::Input(
        Format("imu sample at %s s measures %.3g rad/s and %.3g m/s^2, expected at most %g and %g",
               FormatSeconds(sample.stamp_ns).c_str(), rate, force, kMaxGyroRadps, kMaxAccelMps2));
  }
  if (sample.stamp_ns < consumed_before_ns_) {
    ++statistics_.rejected;
    return Status::Input("imu sample at " + FormatSeconds(sample.stamp_ns) + " s is older than the state");
  }
  if (samples().empty() || samples_.back().stamp_ns < sample.stamp_ns) {
    samples_.push_back(sample);
    ++statistics_.accepted;
    return Status::Ok();
  }
  const auto begin = samples_.begin() + static_cast<std::ptrdiff_t>(begin_);
  const auto place = std::lower_bound(begin, samples_.end(), sample.stamp_ns, Earlier);
  if (place != samples_.end() && place->stamp_ns == sample.stamp_ns) {
    ++statistics_.duplicates;
    return Status::Ok();
  }
  samples_.insert(place, sample);
  ++statistics_.accepted;
  ++statistics_.out_of_order;
  return Status::Ok();
}

Status ImuBuffer::Interval(TimeNs from_ns, TimeNs to_ns, std::vector<ImuSample>* interval) {
  interval->clear();
  const std::span<const ImuSample> held = samples();
  if (to_ns <= from_ns) {
    return Status::Input("imu interval ends at " + FormatSeconds(to_ns) + " s, not after its start " +
                         FormatSeconds(from_ns) + " s");
  }
  if (held.empty() || held.back().stamp_ns < to_ns) {
    return Status::Input("no imu sample reaches " + FormatSeconds(to_ns) + " s" +
                         (held.empty() ? "" : "; missing " + Milliseconds(to_ns - held.back().stamp_ns)));
  }
  if (held.front().stamp_ns > from_ns) {
    return Status::Input("imu starts " + Milliseconds(held.front().stamp_ns - from_ns) + " after " +
                         FormatSeconds(from_ns) + " s");
  }
  const auto first = std::upper_bound(held.begin(), held.end(), from_ns,
                                      [](TimeNs stamp, const ImuSample& s) { return stamp < s.stamp_ns; });
  const auto last = std::lower_bound(first, held.end(), to_ns, Earlier);
  const auto measured = [&](auto sample) {
    ImuSample curved = *sample;
    if (sample - held.begin() >= 2) {
      SetCurvature(*(sample - 2), *(sample - 1), &curved);
    }
    return curved;
  };
  const ImuSample& before = *(first - 1);
  interval->push_back(before.stamp_ns == from_ns ? before : Interpolate(before, measured(first), from_ns));
  for (auto sample = first; sample != last; ++sample) {
    interval->push_back(measured(sample));
  }
  const ImuSample next = measured(last);
  interval->push_back(next.stamp_ns == to_ns ? next : Interpolate(*(last - 1), next, to_ns));
  for (auto sample = first; sample <= last && sample != held.end(); ++sample) {
    const double step_s = SecondsBetween((sample - 1)->stamp_ns, sample->stamp_ns);
    statistics_.longest_gap_s = std::max(statistics_.longest_gap_s, step_s);
    statistics_.gaps += step_s > max_gap_s_ ? 1 : 0;
  }
  return Status::Ok();
}

void ImuBuffer::DropBefore(TimeNs stamp_ns, double kept_s) {
  const TimeNs kept_ns = stamp_ns - SecondsToNs(kept_s);
  // The one before that which comes before the stamp has its part in the next one's curvature.
  while (samples().size() >= 3 && samples()[2].stamp_ns <= kept_ns) {
    ++begin_;
  }
  // Without a sample at or before the stamp, the one that comes before it is still needed.
  if (!samples().empty() && samples().front().stamp_ns <= stamp_ns) {
    consumed_before_ns_ = std::max(consumed_before_ns_, stamp_ns);
  }
  if (2 * begin_ > samples_.size()) {
    samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
  }
}

void ImuBuffer::StartAt(TimeNs stamp_ns, double kept_s) {
  if (!samples().empty() && SecondsBetween(samples_.back().stamp_ns, stamp_ns) > imu_gap::kMinGapS) {
    samples_.clear();
    begin_ = 0;
  }
  DropBefore(stamp_ns, kept_s);
  consumed_before_ns_ = INT64_MIN;
}

}  // namespace alidade
