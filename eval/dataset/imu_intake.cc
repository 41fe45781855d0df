#include "eval/dataset/imu_intake.h"

#include <algorithm>
#include <string>

#include "core/format.h"

namespace alidade {
namespace {

/// Of any two stamps, also of those whose difference does not fit.
std::uint64_t LatenessNs(TimeNs newest_ns, TimeNs stamp_ns) {
  return static_cast<std::uint64_t>(newest_ns) - static_cast<std::uint64_t>(stamp_ns);
}

}  // namespace

std::optional<Status> ImuIntake::Add(const ImuSample& sample) {
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    ++rejections_.not_finite;
    return Status::Input("found a value that is not finite, expected numbers");
  }
  if (samples_.empty() || sample.stamp_ns > samples_.back().stamp_ns) {
    samples_.push_back(sample);
    return std::nullopt;
  }
  const TimeNs newest_ns = samples_.back().stamp_ns;
  if (LatenessNs(newest_ns, sample.stamp_ns) > static_cast<std::uint64_t>(kMaxImuLatenessNs)) {
    ++rejections_.late;
    return Status::Input(Format("found stamp '%lld', expected at most %lld ms before %lld of a row before",
                                static_cast<long long>(sample.stamp_ns),
                                static_cast<long long>(kMaxImuLatenessNs / 1'000'000),
                                static_cast<long long>(newest_ns)));
  }
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
  return text;
}

}  // namespace alidade
