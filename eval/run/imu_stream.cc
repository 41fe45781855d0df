#include "eval/run/imu_stream.h"

#include <algorithm>
#include <utility>

#include "core/imu_gap.h"
#include "core/median.h"

namespace alidade {
namespace {

bool Earlier(const ImuSample& sample, TimeNs stamp_ns) {
  return sample.stamp_ns < stamp_ns;
}

}  // namespace

ImuStream::Arrival ImuStream::Add(const ImuSample& sample) {
  if (sample.stamp_ns <= delivered_ns_) {
    return Arrival::kTooLate;
  }
  if (samples_.empty() || samples_.back().stamp_ns < sample.stamp_ns) {
    samples_.push_back(sample);
  } else {
    const auto place = std::lower_bound(samples_.begin(), samples_.end(), sample.stamp_ns, Earlier);
    if (place->stamp_ns == sample.stamp_ns) {
      return Arrival::kTwice;
    }
    samples_.insert(place, sample);
  }
  if (sample.stamp_ns > newest_ns_) {
    newest_ns_ = sample.stamp_ns;
    newest_gyro_ = sample.gyro;
  }
  return Arrival::kTaken;
}

const ImuSample* ImuStream::Deliver(TimeNs stamp_ns) {
  if (delivered_ns_ >= stamp_ns || delivered_ == samples_.size()) {
    return nullptr;
  }
  ImuSample& sample = samples_[delivered_++];
  delivered_ns_ = sample.stamp_ns;
  if (guarded_) {
    const bool awaited = sample.stamp_ns < stamp_ns && delivered_ < samples_.size();
    fault_ = guard_.Mend(awaited ? &samples_[delivered_] : nullptr, &sample);
  }
  return &sample;
}

std::optional<ImuSample> ImuStream::PassOver(TimeNs stamp_ns) {
  if (delivered_ == samples_.size() || samples_[delivered_].stamp_ns >= stamp_ns) {
    return std::nullopt;
  }
  const ImuSample sample = samples_[delivered_];
  samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(delivered_) + 1);
  delivered_ = 0;
  delivered_ns_ = sample.stamp_ns;
  return sample;
}

std::optional<TimeNs> ImuStream::FirstAtOrAfter(TimeNs stamp_ns) const {
  const auto found = std::lower_bound(samples_.begin(), samples_.end(), stamp_ns, Earlier);
  return found == samples_.end() ? std::nullopt : std::optional(found->stamp_ns);
}

std::optional<TimeNs> ImuStream::UsualStep(size_t before) const {
  constexpr size_t kLeast = 5;
  constexpr size_t kMost = 20;
  std::vector<double> steps;
  for (size_t i = before; i >= 2 && steps.size() < kMost; --i) {
    steps.push_back(static_cast<double>(samples_[i - 1].stamp_ns - samples_[i - 2].stamp_ns));
  }
  return steps.size() < kLeast ? std::nullopt : std::optional(static_cast<TimeNs>(Median(std::move(steps))));
}

std::optional<ImuSilence> ImuStream::FirstSilence(TimeNs after_ns, TimeNs stamp_ns) const {
  constexpr TimeNs kLeastSteps = 4;
  for (size_t i = std::max<size_t>(delivered_, 1); i < samples_.size(); ++i) {
    const TimeNs begin_ns = samples_[i - 1].stamp_ns;
    const TimeNs end_ns = samples_[i].stamp_ns;
    if (begin_ns >= stamp_ns) {
      break;
    }
    const double length_s = SecondsBetween(begin_ns, end_ns);
    if (end_ns > after_ns && length_s > imu_gap::kMinGapS && length_s < kMostSilenceS) {
      const std::optional<TimeNs> usual_ns = UsualStep(i);
      if (usual_ns && end_ns - begin_ns >= kLeastSteps * *usual_ns) {
        return ImuSilence{begin_ns, end_ns, end_ns - begin_ns - *usual_ns};
      }
    }
  }
  return std::nullopt;
}

void ImuStream::TakeBack(const ImuSilence& silence) {
  for (ImuSample& sample : samples_) {
    sample.stamp_ns -= sample.stamp_ns >= silence.end_ns ? silence.excess_ns : 0;
  }
  newest_ns_ -= newest_ns_ >= silence.end_ns ? silence.excess_ns : 0;
}

std::vector<ImuSample> ImuStream::DeliveredSince(TimeNs stamp_ns) const {
  return Range(stamp_ns, delivered_);
}

std::vector<ImuSample> ImuStream::Since(TimeNs stamp_ns) const {
  std::vector<ImuSample> range = Range(stamp_ns, samples_.size());
  for (ImuSample& sample : range) {
    if (sample.stamp_ns > delivered_ns_) {
      sample.gyro = guard_.InRadians(sample.gyro);
    }
  }
  return range;
}

std::vector<ImuSample> ImuStream::Range(TimeNs stamp_ns, size_t end) const {
  const auto last = samples_.begin() + static_cast<std::ptrdiff_t>(end);
  auto first = std::upper_bound(samples_.begin(), last, stamp_ns, [](TimeNs stamp, const ImuSample& sample) {
    return stamp < sample.stamp_ns;
  });
  // One more than covers the stamp, for the curvature after it (core/imu_step.h).
  first -= std::min<std::ptrdiff_t>(2, first - samples_.begin());
  return {first, last};
}

void ImuStream::DropBefore(TimeNs stamp_ns) {
  while (delivered_ >= 3 && samples_[2].stamp_ns <= stamp_ns) {
    samples_.pop_front();
    --delivered_;
  }
}

}  // namespace alidade
