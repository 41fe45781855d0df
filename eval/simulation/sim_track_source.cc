#include "eval/simulation/sim_track_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace alidade {
namespace {

constexpr int kRowPasses = 8;

}  // namespace

TrackSource::TrackSource(const SimulatorConfig& config, const CameraModel& camera,
                         const std::vector<Eigen::Vector3d>& landmarks, std::uint64_t seed,
                         const std::string& camera_name, std::int64_t first_id)
    : config_(config),
      camera_(camera),
      landmarks_(landmarks),
      first_id_(first_id),
      loss_(seed, camera_name + ".track_loss"),
      selection_(seed, camera_name + ".selection"),
      noise_(seed, camera_name + ".pixel_noise"),
      ratio_(seed, camera_name + ".noise_ratio"),
      faults_(config, seed, camera_name),
      loss_draw_(landmarks.size()),
      priority_(landmarks.size()),
      noise_px_(landmarks.size()),
      noise_ratio_(landmarks.size(), 1) {}

TrackFrame TrackSource::Observe(TimeNs stamp_ns, const ImageExposure& exposure,
                                const std::vector<TrackedPoint>& elsewhere) {
  ++frame_;
  stamp_ns_ = stamp_ns;
  exposure_ = &exposure;
  T_CW_ = exposure.CameraAt(0.5 * camera_.height_px()).Inverse();
  TrackFrame frame;
  frame.stamp_ns = stamp_ns;
  Deal();
  ProjectLandmarks();
  TakeOver(elsewhere, &frame);
  DropLostTracks();
  SwapTracks();
  StartTracks(frame.observations.size());
  MeasureTracks(&frame);
  return frame;
}

std::vector<TrackedPoint> TrackSource::Tracked() const {
  std::vector<TrackedPoint> points;
  points.reserve(live_.size());
  for (const LiveTrack& track : live_) {
    points.push_back({track.id, track.landmark, PositionOf(track)});
  }
  return points;
}

void TrackSource::Deal() {
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    loss_draw_[i] = loss_.Uniform();
    priority_[i] = selection_.Uniform();
    if (config_.noise_ratio_spread > 0) {
      noise_ratio_[i] = std::exp(config_.noise_ratio_spread * ratio_.Normal());
    }
    const double deviation_px = config_.pixel_noise_px * noise_ratio_[i];
    noise_px_[i].x() = deviation_px * noise_.Normal();
    noise_px_[i].y() = deviation_px * noise_.Normal();
  }
}

std::optional<Eigen::Vector2d> TrackSource::See(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d p_C = T_CW_ * p_W;
  Eigen::Vector2d pixel;
  bool visible =
      p_C.squaredNorm() <= config_.max_range_m * config_.max_range_m && camera_.Project(p_C, &pixel);
  // Row and time of the exposure depend on each other: each pass divides the error by the rows that pass
  // while the image moves by one, 10 or more.
  for (int pass = 0; visible && !exposure_->at_once() && pass < kRowPasses; ++pass) {
    visible = camera_.Project(exposure_->CameraAt(pixel.y()).Inverse() * p_W, &pixel);
  }
  return visible && camera_.InImage(pixel, config_.border_px) ? std::optional(pixel) : std::nullopt;
}

void TrackSource::ProjectLandmarks() {
  pixels_.clear();
  for (const Eigen::Vector3d& p_W : landmarks_) {
    pixels_.push_back(See(p_W));
  }
}

/// Landmarks that the other camera tracks are not for tracks of our own.
void TrackSource::TakeOver(const std::vector<TrackedPoint>& elsewhere, TrackFrame* frame) {
  is_tracked_.assign(landmarks_.size(), false);
  for (const TrackedPoint& point : elsewhere) {
    const auto landmark = static_cast<std::size_t>(point.landmark);
    const std::optional<Eigen::Vector2d> pixel = See(point.p_W);
    is_tracked_[landmark] = true;
    if (pixel.has_value()) {
      frame->observations.push_back({point.id, *pixel + noise_px_[landmark], noise_ratio_[landmark]});
    }
  }
}

Eigen::Vector3d TrackSource::PositionOf(const LiveTrack& track) const {
  const Eigen::Vector3d& p_W = landmarks_[static_cast<std::size_t>(track.landmark)];
  return track.fault.wrong && track.fault.kind == SimOutlierKind::kMoving
             ? p_W + SecondsBetween(track.born_ns, stamp_ns_) * track.fault.velocity_W_mps
             : p_W;
}

std::optional<Eigen::Vector2d> TrackSource::AppearanceOf(const LiveTrack& track) const {
  const TrackFault& fault = track.fault;
  std::optional<Eigen::Vector2d> pixel = fault.wrong && fault.kind == SimOutlierKind::kMoving
                                             ? See(PositionOf(track))
                                             : pixels_[static_cast<std::size_t>(track.landmark)];
  if (!fault.wrong || !pixel.has_value() || track.frames < fault.onset) {
    return pixel;
  }
  Eigen::Vector2d wrong = *pixel;
  if (fault.kind == SimOutlierKind::kUniform) {
    wrong = faults_.AnyPixel(track.landmark, frame_, camera_.width_px(), camera_.height_px());
  } else if (fault.kind == SimOutlierKind::kJump) {
    wrong += fault.jump_px;
  } else if (fault.kind == SimOutlierKind::kDrift) {
    wrong += SecondsBetween(track.born_ns, stamp_ns_) * fault.drift_px_per_s;
  }
  return camera_.InImage(wrong) ? std::optional(wrong) : std::nullopt;
}

void TrackSource::DropLostTracks() {
  std::vector<LiveTrack> kept;
  for (LiveTrack& track : live_) {
    const auto landmark = static_cast<std::size_t>(track.landmark);
    ++track.frames;
    const std::optional<Eigen::Vector2d> pixel = AppearanceOf(track);
    const bool lost = loss_draw_[landmark] < config_.mean_track_loss;
    if (pixel.has_value() && !lost && !is_tracked_[landmark]) {
      track.pixel = *pixel;
      is_tracked_[landmark] = true;
      kept.push_back(track);
    }
  }
  live_ = std::move(kept);
}

/// Those due to swap exchange their landmarks two by two, once in their lives.
void TrackSource::SwapTracks() {
  LiveTrack* waiting = nullptr;
  for (LiveTrack& track : live_) {
    const TrackFault& fault = track.fault;
    if (!fault.wrong || fault.kind != SimOutlierKind::kSwap || track.swapped || track.frames < fault.onset) {
      continue;
    }
    if (waiting == nullptr) {
      waiting = &track;
      continue;
    }
    std::swap(track.landmark, waiting->landmark);
    std::swap(track.pixel, waiting->pixel);
    track.swapped = waiting->swapped = true;
    waiting = nullptr;
  }
}

void TrackSource::StartTracks(std::size_t places_taken) {
  const auto places = static_cast<std::size_t>(config_.max_features);
  if (places_taken + live_.size() >= places) {
    return;
  }
  std::vector<int> candidates;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    if (pixels_[i].has_value() && !is_tracked_[i]) {
      candidates.push_back(static_cast<int>(i));
    }
  }
  const std::size_t free = std::min(candidates.size(), places - places_taken - live_.size());
  const auto end = candidates.begin() + static_cast<std::ptrdiff_t>(free);
  std::partial_sort(candidates.begin(), end, candidates.end(), [this](int a, int b) {
    return std::pair(priority_[static_cast<std::size_t>(a)], a) <
           std::pair(priority_[static_cast<std::size_t>(b)], b);
  });
  candidates.erase(end, candidates.end());
  for (const int landmark : candidates) {
    // Ids grow with birth, so live_ stays sorted by id.
    LiveTrack track;
    track.id = first_id_ + static_cast<std::int64_t>(landmark_of_track_.size());
    track.landmark = landmark;
    track.born_ns = stamp_ns_;
    track.fault = faults_.OfTrack(landmark, frame_);
    landmark_of_track_.push_back(landmark);
    outlier_of_track_.push_back(false);
    const std::optional<Eigen::Vector2d> pixel = AppearanceOf(track);
    track.pixel = pixel.value_or(*pixels_[static_cast<std::size_t>(landmark)]);
    live_.push_back(track);
  }
}

void TrackSource::MarkWrong(const LiveTrack& track) {
  outlier_of_track_[static_cast<std::size_t>(track.id - first_id_)] = true;
}

Eigen::Vector2d TrackSource::Clamped(const Eigen::Vector2d& pixel) const {
  return {std::clamp(pixel.x(), 0.0, camera_.width_px() - 1.0),
          std::clamp(pixel.y(), 0.0, camera_.height_px() - 1.0)};
}

void TrackSource::MeasureTracks(TrackFrame* frame) {
  const std::size_t first = frame->observations.size();
  std::vector<std::size_t> to_swap;
  for (const LiveTrack& track : live_) {
    Eigen::Vector2d pixel = track.pixel + noise_px_[static_cast<std::size_t>(track.landmark)];
    const bool due = track.fault.wrong && track.frames >= track.fault.onset;
    if (due && (track.fault.kind != SimOutlierKind::kSwap || track.swapped)) {
      MarkWrong(track);
      pixel = Clamped(pixel);
    }
    if (faults_.OfObservation(track.landmark, frame_)) {
      if (config_.outlier_kind == SimOutlierKind::kSwap) {
        to_swap.push_back(frame->observations.size());
      } else {
        MarkWrong(track);
        pixel = config_.outlier_kind == SimOutlierKind::kJump
                    ? Clamped(pixel + faults_.Jump(track.landmark, frame_))
                    : faults_.AnyPixel(track.landmark, frame_, camera_.width_px(), camera_.height_px());
      }
    }
    frame->observations.push_back({track.id, pixel, noise_ratio_[static_cast<std::size_t>(track.landmark)]});
  }
  if (to_swap.size() > 1) {
    for (const std::size_t i : to_swap) {
      MarkWrong(live_[i - first]);
    }
    SwapObservations(to_swap, frame);
  }
}

/// Each of the pool gets the pixel of the next one.
void TrackSource::SwapObservations(const std::vector<std::size_t>& pool, TrackFrame* frame) {
  const Eigen::Vector2d head = frame->observations[pool.front()].pixel;
  for (std::size_t i = 0; i + 1 < pool.size(); ++i) {
    frame->observations[pool[i]].pixel = frame->observations[pool[i + 1]].pixel;
  }
  frame->observations[pool.back()].pixel = head;
}

}  // namespace alidade
