#include "eval/dataset/imu_intake.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/format.h"
#include "core/median.h"

namespace alidade {
namespace {

/// Of any two stamps, also of those whose difference does not fit.
std::uint64_t LatenessNs(TimeNs newest_ns, TimeNs stamp_ns) {
  return static_cast<std::uint64_t>(newest_ns) - static_cast<std::uint64_t>(stamp_ns);
}

}  // namespace

void ImuIntake::Append(const ImuSample& sample) {
  constexpr TimeNs kHoleSteps = 4;
  if (samples_.empty()) {
    covered_ns_ = sample.stamp_ns;
  } else {
    const TimeNs step_ns = sample.stamp_ns - samples_.back().stamp_ns;
    if (last_step_ns_ > 0 && step_ns / kHoleSteps > last_step_ns_) {
      covered_ns_ = sample.stamp_ns;
    }
    last_step_ns_ = step_ns;
  }
  samples_.push_back(sample);
}

bool ImuIntake::FindSetBack(const ImuSample& sample) {
  if (!late_.empty() && sample.stamp_ns <= late_.back().stamp_ns) {
    late_.clear();
  }
  if (late_.size() == kSetBackRows) {  // their place was refused
    late_.back() = sample;
    return false;
  }
  late_.push_back(sample);
  if (late_.size() < kSetBackRows || late_.front().stamp_ns <= covered_ns_) {
    return false;
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < late_.size(); ++i) {
    steps.push_back(static_cast<double>(late_[i].stamp_ns - late_[i - 1].stamp_ns));
  }
  const TimeNs usual_ns = static_cast<TimeNs>(Median(std::move(steps)));
  const TimeNs jump_ns = samples_.back().stamp_ns + usual_ns - late_.front().stamp_ns;
  for (ImuSample moved : late_) {
    moved.stamp_ns += jump_ns;
    Append(moved);
  }
  moved_ns_ += jump_ns;
  rejections_.late -= late_.size() - 1;
  rejections_.set_back_s = SecondsBetween(0, moved_ns_);
  late_.clear();
  return true;
}

std::optional<Status> ImuIntake::Add(const ImuSample& as_stamped) {
  ImuSample sample = as_stamped;
  sample.stamp_ns += moved_ns_;
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    ++rejections_.not_finite;
    return Status::Input("found a value that is not finite, expected numbers");
  }
  if (samples_.empty() || sample.stamp_ns > samples_.back().stamp_ns) {
    Append(sample);
    late_.clear();
    return std::nullopt;
  }
  const TimeNs newest_ns = samples_.back().stamp_ns;
  if (LatenessNs(newest_ns, sample.stamp_ns) > static_cast<std::uint64_t>(kMaxImuLatenessNs)) {
    if (FindSetBack(sample)) {
      return std::nullopt;
    }
    ++rejections_.late;
    return Status::Input(Format("found stamp '%lld', expected at most %lld ms before %lld of a row before",
                                static_cast<long long>(sample.stamp_ns),
                                static_cast<long long>(kMaxImuLatenessNs / 1'000'000),
                                static_cast<long long>(newest_ns)));
  }
  late_.clear();
  const auto earlier = [](const ImuSample& a, const ImuSample& b) { return a.stamp_ns < b.stamp_ns; };
  const auto place = std::lower_bound(samples_.begin(), samples_.end(), sample, earlier);
  if (place->stamp_ns == sample.stamp_ns) {
    ++rejections_.duplicate;
    return Status::Input("found stamp '" + std::to_string(sample.stamp_ns) +
                         "' of a row before, expected it once");
  }
  samples_.insert(place, sample);
  ++rejections_.reordered;
  return std::nullopt;
}

std::vector<ImuSample> ImuIntake::TakeSettled() {
  const auto settled = std::find_if(samples_.begin(), samples_.end(), [this](const ImuSample& sample) {
    return LatenessNs(samples_.back().stamp_ns, sample.stamp_ns) <=
           static_cast<std::uint64_t>(kMaxImuLatenessNs);
  });
  std::vector<ImuSample> taken(samples_.begin(), settled);
  samples_.erase(samples_.begin(), settled);
  return taken;
}

std::string DescribeRejections(const ImuRejections& rejections) {
  std::string text;
  if (rejections.dropped() > 0) {
    text = Format("%zu dropped (%zu duplicate, %zu late, %zu not finite)", rejections.dropped(),
                  rejections.duplicate, rejections.late, rejections.not_finite);
  }
  if (rejections.reordered > 0) {
    text += (text.empty() ? "" : ", ") + Format("%zu put in order", rejections.reordered);
  }
  if (rejections.set_back_s > 0) {
    text += (text.empty() ? "" : ", ") + Format("the clock set back by %.3f s", rejections.set_back_s);
  }
  return text;
}

}  // namespace alidade
