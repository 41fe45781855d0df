#include "eval/calibrate/frame_pairs.h"

#include <algorithm>

#include "core/median.h"

namespace alidade {
namespace {

std::vector<PairView> SharedViews(const TrackFrame& a, const TrackFrame& b) {
  std::vector<PairView> views;
  auto in_b = b.observations.begin();
  for (const TrackObservation& observation : a.observations) {
    while (in_b != b.observations.end() && in_b->track_id < observation.track_id) {
      ++in_b;
    }
    if (in_b != b.observations.end() && in_b->track_id == observation.track_id) {
      views.push_back({observation.pixel, in_b->pixel});
    }
  }
  return views;
}

double MedianFlow(const std::vector<PairView>& views) {
  std::vector<double> flow;
  flow.reserve(views.size());
  for (const PairView& view : views) {
    flow.push_back((view.pixel_j - view.pixel_i).norm());
  }
  return Median(std::move(flow));
}

/// Silences of the IMU, as stamps of the samples around them.
class ImuGaps {
 public:
  ImuGaps(const std::vector<ImuSample>& imu, double longest_s) {
    for (std::size_t k = 1; k < imu.size(); ++k) {
      if (SecondsBetween(imu[k - 1].stamp_ns, imu[k].stamp_ns) > longest_s) {
        gaps_.emplace_back(imu[k - 1].stamp_ns, imu[k].stamp_ns);
      }
    }
  }
  [[nodiscard]] bool Within(TimeNs from_ns, TimeNs to_ns) const {
    return std::any_of(gaps_.begin(), gaps_.end(),
                       [&](const auto& gap) { return gap.first < to_ns && gap.second > from_ns; });
  }

 private:
  std::vector<std::pair<TimeNs, TimeNs>> gaps_;
};

}  // namespace

std::vector<FramePair> ChooseFramePairs(const std::vector<TrackFrame>& frames,
                                        const std::vector<ImuSample>& imu, const FramePairOptions& options) {
  std::vector<FramePair> pairs;
  if (imu.size() < 2) {
    return pairs;
  }
  const ImuGaps gaps(imu, options.longest_gap_s);
  const TimeNs margin_ns = SecondsToNs(options.margin_s);
  const TimeNs begin_ns = imu.front().stamp_ns + margin_ns;
  const TimeNs end_ns = imu.back().stamp_ns - margin_ns;
  std::size_t i = 0;
  while (i + 1 < frames.size()) {
    std::vector<PairView> views;
    double flow_px = 0;
    std::size_t partner = i;
    for (std::size_t j = i + 1; j < frames.size() && flow_px < options.least_flow_px &&
                                SecondsBetween(frames[i].stamp_ns, frames[j].stamp_ns) <= options.longest_s;
         ++j) {
      std::vector<PairView> shared = SharedViews(frames[i], frames[j]);
      if (shared.size() < options.least_views) {
        break;
      }
      flow_px = MedianFlow(shared);
      views = std::move(shared);
      partner = j;
    }
    const bool usable = 3 * flow_px >= options.least_flow_px && frames[i].stamp_ns >= begin_ns &&
                        frames[partner].stamp_ns <= end_ns &&
                        !gaps.Within(frames[i].stamp_ns - margin_ns, frames[partner].stamp_ns + margin_ns);
    if (usable) {
      pairs.push_back({SecondsBetween(imu.front().stamp_ns, frames[i].stamp_ns),
                       SecondsBetween(imu.front().stamp_ns, frames[partner].stamp_ns), std::move(views)});
    }
    i = usable ? partner : i + 1;
  }
  return pairs;
}

}  // namespace alidade
