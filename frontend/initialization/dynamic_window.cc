#include "frontend/initialization/dynamic_window.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/format.h"
#include "core/pixel_noise.h"

namespace alidade {
namespace {

/// Indices of the frames to use, oldest first.
std::vector<size_t> SelectFrames(const InitConfig& config, const std::deque<TrackFrame>& frames,
                                 double longest_s) {
  const TimeNs newest = frames.back().stamp_ns;
  const TimeNs from = newest - SecondsToNs(longest_s) - 1000;
  size_t first = 0;
  while (first < frames.size() && frames[first].stamp_ns < from) {
    ++first;
  }
  const size_t min_frames = static_cast<size_t>(config.dynamic_min_frames);
  if (frames.size() >= min_frames) {
    first = std::min(first, frames.size() - min_frames);
  }
  const size_t available = frames.size() - first;
  const size_t wanted = std::min<size_t>(available, std::max<size_t>(kMaxWindowFrames, min_frames));
  std::vector<size_t> selected;
  for (size_t k = 0; k < wanted; ++k) {
    selected.push_back(wanted == 1 ? first : first + k * (available - 1) / (wanted - 1));
  }
  return selected;
}

std::vector<SharedTrack> CollectTracks(const EstimatorConfig& config, const CameraModel& camera,
                                       const std::deque<TrackFrame>& frames,
                                       const std::vector<size_t>& selected) {
  std::map<std::int64_t, SharedTrack> by_id;
  const PixelNoise noise(config.vision);
  for (size_t k = 0; k < selected.size(); ++k) {
    for (const TrackObservation& seen : frames[selected[k]].observations) {
      NormalizedObservation observation;
      if (seen.pixel.allFinite() && NormalizeObservation(camera, seen.pixel, noise.Of(seen), &observation)) {
        SharedTrack& track = by_id[seen.track_id];
        track.track_id = seen.track_id;
        track.frames.push_back(static_cast<int>(k));
        track.observations.push_back(observation);
      }
    }
  }
  std::vector<SharedTrack> tracks;
  for (auto& [id, track] : by_id) {
    if (track.frames.size() >= 2) {
      tracks.push_back(std::move(track));
    }
  }
  std::stable_sort(tracks.begin(), tracks.end(), [](const SharedTrack& a, const SharedTrack& b) {
    return a.frames.size() > b.frames.size();
  });
  if (tracks.size() > kMaxWindowTracks) {
    tracks.resize(kMaxWindowTracks);
  }
  return tracks;
}

}  // namespace

Status BuildDynamicWindow(const EstimatorConfig& config, const CameraModel& camera,
                          const std::deque<TrackFrame>& frames, double longest_s, ImuBuffer* imu,
                          DynamicWindow* window) {
  *window = DynamicWindow();
  const double span_s = frames.empty() ? 0 : SecondsBetween(frames.front().stamp_ns, frames.back().stamp_ns);
  if (static_cast<int>(frames.size()) < config.init.dynamic_min_frames) {
    return Status::Diverged(
        Format("moving: %zu frames of %d", frames.size(), config.init.dynamic_min_frames));
  }
  if (span_s < 0.95 * config.init.dynamic_window_s) {
    return Status::Diverged(
        Format("moving: %.2f s of %.2f s collected", span_s, config.init.dynamic_window_s));
  }
  const std::vector<size_t> selected = SelectFrames(config.init, frames, longest_s);
  for (const size_t index : selected) {
    window->stamps_ns.push_back(frames[index].stamp_ns);
  }
  for (size_t k = 0; k + 1 < selected.size(); ++k) {
    std::vector<ImuSample> samples;
    const Status status = imu->Interval(window->stamps_ns[k], window->stamps_ns[k + 1], &samples);
    if (!status.ok()) {
      return Status::Diverged("moving: " + status.message());
    }
    window->imu.push_back(std::move(samples));
  }
  window->tracks = CollectTracks(config, camera, frames, selected);
  return Status::Ok();
}

std::vector<Preintegration> PreintegrateWindow(const DynamicWindow& window, const ImuBias& bias,
                                               const ImuNoise& noise) {
  std::vector<Preintegration> preintegrations;
  for (const std::vector<ImuSample>& samples : window.imu) {
    preintegrations.emplace_back(bias, noise);
    preintegrations.back().Add(samples);
  }
  return preintegrations;
}

Eigen::Vector3d BearingOf(const NormalizedObservation& observation) {
  return observation.plane.is_tangent() ? observation.Ray().normalized()
                                        : observation.z.homogeneous().normalized();
}

double AngularDeviation(const NormalizedObservation& observation) {
  // The plane's area element seen from the centre is cos^3 of the angle off axis.
  return observation.deviation() * std::pow(1 + observation.z.squaredNorm(), -0.75);
}

}  // namespace alidade
