#include "filter/track_store.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace alidade {

TrackStore::TrackStore(int max_views, bool with_memory, int calibration_size)
    : max_views_(max_views), memory_columns_(with_memory ? 6 * max_views + calibration_size : 0) {
  tracks_.reserve(kUsualTracks);
  merged_.reserve(kUsualTracks);
  spare_.reserve(kUsualTracks);
  while (spare_.size() < kUsualTracks) {
    spare_.push_back(MakeTrack());
  }
}

Track TrackStore::MakeTrack() const {
  Track track;
  track.views.reserve(static_cast<size_t>(max_views_));
  track.memory.clone_rows.resize(3, memory_columns_);
  return track;
}

Track TrackStore::TakeSpare(std::int64_t id) {
  if (spare_.empty()) {
    spare_.push_back(MakeTrack());
  }
  Track track = std::move(spare_.back());
  spare_.pop_back();
  track.id = id;
  track.views.clear();
  track.base_rounds = 0;
  track.last_serial = -1;
  track.memory.active = false;
  track.observations = 0;
  track.in_state = false;
  return track;
}

int TrackStore::AddFrame(const CameraModel& camera, const PixelNoise& noise, int serial,
                         const std::vector<TrackObservation>& observations) {
  int invalid = 0;
  merged_.clear();
  size_t next = 0;
  for (const TrackObservation& seen : observations) {
    while (next < tracks_.size() && tracks_[next].id < seen.track_id) {
      merged_.push_back(std::move(tracks_[next++]));
    }
    const bool known = next < tracks_.size() && tracks_[next].id == seen.track_id;
    TrackView view;
    view.serial = serial;
    view.pixel = seen.pixel;
    view.noise_ratio = noise.Ratio(seen);
    if (!NormalizeObservation(camera, seen.pixel, noise.Of(seen), &view.observation)) {
      ++invalid;
      continue;
    }
    merged_.push_back(known ? std::move(tracks_[next++]) : TakeSpare(seen.track_id));
    merged_.back().views.push_back(view);
    merged_.back().last_serial = serial;
    ++merged_.back().observations;
  }
  while (next < tracks_.size()) {
    merged_.push_back(std::move(tracks_[next++]));
  }
  tracks_.swap(merged_);
  return invalid;
}

void TrackStore::Renormalize(const CalibrationLayout& layout, const CameraModel& camera,
                             double pixel_noise_px) {
  if (layout.intrinsics() < 0) {
    return;
  }
  for (Track& track : tracks_) {
    for (TrackView& view : track.views) {
      static_cast<void>(
          RenormalizeObservation(camera, view.pixel, pixel_noise_px * view.noise_ratio, &view.observation));
    }
  }
}

void TrackStore::RemoveEnded(int serial) {
  const auto ended = [serial](const Track& track) { return track.last_serial != serial; };
  merged_.clear();
  for (Track& track : tracks_) {
    (ended(track) ? spare_ : merged_).push_back(std::move(track));
  }
  tracks_.swap(merged_);
}

void TrackStore::RemoveClone(int serial) {
  for (Track& track : tracks_) {
    const auto view = std::find_if(track.views.begin(), track.views.end(),
                                   [serial](const TrackView& v) { return v.serial == serial; });
    if (view == track.views.end()) {
      continue;
    }
    if (view == track.views.begin()) {
      track.base_rounds = 0;
    }
    track.views.erase(view);
  }
}

Track* TrackStore::Find(std::int64_t id) {
  const auto found =
      std::lower_bound(tracks_.begin(), tracks_.end(), id,
                       [](const Track& track, std::int64_t value) { return track.id < value; });
  return found != tracks_.end() && found->id == id ? &*found : nullptr;
}

void TrackStore::Clear() {
  std::move(tracks_.begin(), tracks_.end(), std::back_inserter(spare_));
  tracks_.clear();
  merged_.clear();
}

}  // namespace alidade
