#include "eval/calibrate/frame_pairs.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

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
  ImuGaps(const Table<ImuSample>& imu, double longest_s) {
    TimeNs before_ns = imu.front().stamp_ns;
    // Here and below, a file that cannot be read again is reported by its next reader.
    static_cast<void>(imu.ForEach([&](const ImuSample& sample) {
      if (SecondsBetween(before_ns, sample.stamp_ns) > longest_s) {
        gaps_.emplace_back(before_ns, sample.stamp_ns);
      }
      before_ns = sample.stamp_ns;
    }));
  }
  [[nodiscard]] bool Within(TimeNs from_ns, TimeNs to_ns) const {
    return std::any_of(gaps_.begin(), gaps_.end(),
                       [&](const auto& gap) { return gap.first < to_ns && gap.second > from_ns; });
  }

 private:
  std::vector<std::pair<TimeNs, TimeNs>> gaps_;
};

/// The frames of a table from one that moves forward on.
class FrameWindow {
 public:
  explicit FrameWindow(const Table<TrackFrame>& frames) : pass_(frames) {}

  /// Null behind the last. Precondition: not dropped.
  const TrackFrame* At(std::size_t index) {
    while (first_ + frames_.size() <= index) {
      const Result<const TrackFrame*> next = pass_.Next();
      if (!next.ok() || *next == nullptr) {
        return nullptr;
      }
      frames_.push_back(**next);
    }
    return &frames_[index - first_];
  }
  void DropBefore(std::size_t index) {
    for (; first_ < index && !frames_.empty(); ++first_) {
      frames_.pop_front();
    }
  }

 private:
  Table<TrackFrame>::Pass pass_;
  std::size_t first_ = 0;
  std::deque<TrackFrame> frames_;
};

/// One pass along a recording.
class PairWalk {
 public:
  PairWalk(const LogTables& tables, const FramePairOptions& options, const ImuGaps& gaps)
      : options_(options),
        gaps_(gaps),
        frames_(tables.frames),
        margin_ns_(SecondsToNs(options.margin_s)),
        origin_ns_(tables.imu.front().stamp_ns),
        begin_ns_(origin_ns_ + margin_ns_),
        end_ns_(tables.imu.back().stamp_ns - margin_ns_) {}

  /// The next pair; nothing at the end.
  std::optional<FramePair> Next() {
    while (frames_.At(at_ + 1) != nullptr) {
      std::size_t partner = at_;
      std::optional<FramePair> pair = From(at_, &partner);
      at_ = pair ? partner : at_ + 1;
      frames_.DropBefore(at_);
      if (pair) {
        return pair;
      }
    }
    return std::nullopt;
  }

 private:
  std::optional<FramePair> From(std::size_t i, std::size_t* partner) {
    const TrackFrame first = *frames_.At(i);
    TimeNs last_ns = first.stamp_ns;
    std::vector<PairView> views;
    double flow_px = 0;
    for (std::size_t j = i + 1; flow_px < options_.least_flow_px; ++j) {
      const TrackFrame* frame = frames_.At(j);
      if (frame == nullptr || SecondsBetween(first.stamp_ns, frame->stamp_ns) > options_.longest_s) {
        break;
      }
      std::vector<PairView> shared = SharedViews(first, *frame);
      if (shared.size() < options_.least_views) {
        break;
      }
      flow_px = MedianFlow(shared);
      views = std::move(shared);
      *partner = j;
      last_ns = frame->stamp_ns;
    }
    const bool usable = 3 * flow_px >= options_.least_flow_px && first.stamp_ns >= begin_ns_ &&
                        last_ns <= end_ns_ &&
                        !gaps_.Within(first.stamp_ns - margin_ns_, last_ns + margin_ns_);
    return usable ? std::optional(FramePair{SecondsBetween(origin_ns_, first.stamp_ns),
                                            SecondsBetween(origin_ns_, last_ns), std::move(views)})
                  : std::nullopt;
  }

  const FramePairOptions& options_;
  const ImuGaps& gaps_;
  FrameWindow frames_;
  TimeNs margin_ns_, origin_ns_, begin_ns_, end_ns_;
  std::size_t at_ = 0;
};

/// Of `count` in a row, `most` that are spread evenly.
std::vector<std::size_t> Spread(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen;
  for (std::size_t k = 0; k < std::min(count, most); ++k) {
    chosen.push_back(count <= most ? k : k * count / most);
  }
  return chosen;
}

}  // namespace

std::vector<FramePair> ChooseFramePairs(const LogTables& tables, const FramePairOptions& options,
                                        std::size_t most) {
  if (tables.imu.size() < 2) {
    return {};
  }
  const ImuGaps gaps(tables.imu, options.longest_gap_s);
  std::size_t count = 0;
  for (PairWalk walk(tables, options, gaps); walk.Next();) {
    ++count;
  }
  // All of them may not fit into memory: those that are wanted come from a second pass.
  std::vector<FramePair> pairs;
  PairWalk walk(tables, options, gaps);
  std::size_t passed = 0;
  for (const std::size_t wanted : Spread(count, most)) {
    std::optional<FramePair> pair = walk.Next();
    for (; pair && passed < wanted; ++passed) {
      pair = walk.Next();
    }
    if (!pair) {
      break;
    }
    pairs.push_back(std::move(*pair));
    ++passed;
  }
  return pairs;
}

std::vector<ImuSample> SamplesAround(const std::vector<FramePair>& pairs, const Table<ImuSample>& imu,
                                     double margin_s) {
  constexpr std::size_t kLeast = 2;
  std::vector<ImuSample> samples;
  auto pair = pairs.begin();
  static_cast<void>(imu.ForEach([&](const ImuSample& sample) {
    const double t_s = SecondsBetween(imu.front().stamp_ns, sample.stamp_ns);
    while (pair != pairs.end() && pair->t_j_s + margin_s < t_s) {
      ++pair;
    }
    if (samples.size() < kLeast || sample.stamp_ns == imu.back().stamp_ns ||
        (pair != pairs.end() && pair->t_i_s - margin_s <= t_s)) {
      samples.push_back(sample);
    }
  }));
  return samples;
}

}  // namespace alidade
