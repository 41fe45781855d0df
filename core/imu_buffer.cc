#include "core/imu_buffer.h"

#include <algorithm>
#include <string>

#include "core/check.h"

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
  const double w = SecondsBetween(a.stamp_ns, stamp_ns) / SecondsBetween(a.stamp_ns, b.stamp_ns);
  return {stamp_ns, (1 - w) * a.gyro + w * b.gyro, (1 - w) * a.accel + w * b.accel};
}

Status ImuBuffer::Add(const ImuSample& sample) {
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    ++statistics_.rejected;
    return Status::Input("imu sample at " + FormatSeconds(sample.stamp_ns) + " s is not finite");
  }
  if (sample.stamp_ns < consumed_before_ns_) {
    ++statistics_.rejected;
    return Status::Input("imu sample at " + FormatSeconds(sample.stamp_ns) + " s is older than the state");
  }
  if (samples_.empty() || samples_.back().stamp_ns < sample.stamp_ns) {
    samples_.push_back(sample);
    ++statistics_.accepted;
    return Status::Ok();
  }
  const auto place = std::lower_bound(samples_.begin(), samples_.end(), sample.stamp_ns, Earlier);
  if (place != samples_.end() && place->stamp_ns == sample.stamp_ns) {
    ++statistics_.duplicates;
    return Status::Ok();
  }
  samples_.insert(place, sample);
  ++statistics_.accepted;
  ++statistics_.out_of_order;
  return Status::Ok();
}

Status ImuBuffer::Interval(TimeNs from_ns, TimeNs to_ns, std::vector<ImuSample>* samples) {
  samples->clear();
  if (to_ns <= from_ns) {
    return Status::Input("imu interval ends at " + FormatSeconds(to_ns) + " s, not after its start " +
                         FormatSeconds(from_ns) + " s");
  }
  if (samples_.empty() || samples_.back().stamp_ns < to_ns) {
    return Status::Input(
        "no imu sample reaches " + FormatSeconds(to_ns) + " s" +
        (samples_.empty() ? "" : "; missing " + Milliseconds(to_ns - samples_.back().stamp_ns)));
  }
  if (samples_.front().stamp_ns > from_ns) {
    return Status::Input("imu starts " + Milliseconds(samples_.front().stamp_ns - from_ns) + " after " +
                         FormatSeconds(from_ns) + " s");
  }
  const auto first = std::upper_bound(samples_.begin(), samples_.end(), from_ns,
                                      [](TimeNs stamp, const ImuSample& s) { return stamp < s.stamp_ns; });
  const auto last = std::lower_bound(first, samples_.end(), to_ns, Earlier);
  const ImuSample& before = *(first - 1);
  samples->push_back(before.stamp_ns == from_ns ? before : Interpolate(before, *first, from_ns));
  samples->insert(samples->end(), first, last);
  samples->push_back(last->stamp_ns == to_ns ? *last : Interpolate(*(last - 1), *last, to_ns));
  for (auto sample = first; sample <= last && sample != samples_.end(); ++sample) {
    const double step_s = SecondsBetween((sample - 1)->stamp_ns, sample->stamp_ns);
    statistics_.longest_gap_s = std::max(statistics_.longest_gap_s, step_s);
    statistics_.gaps += step_s > max_gap_s_ ? 1 : 0;
  }
  return Status::Ok();
}

void ImuBuffer::DropBefore(TimeNs stamp_ns) {
  while (samples_.size() >= 2 && samples_[1].stamp_ns <= stamp_ns) {
    samples_.pop_front();
  }
  // Without a sample at or before the stamp, the one that comes before it is still needed.
  if (!samples_.empty() && samples_.front().stamp_ns <= stamp_ns) {
    consumed_before_ns_ = std::max(consumed_before_ns_, stamp_ns);
  }
}

}  // namespace alidade
