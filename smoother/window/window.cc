#include "smoother/window/window.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/calibration.h"
#include "core/check.h"
#include "core/reprojection.h"
#include "core/turned_ray.h"
#include "smoother/manifold/nav_state_manifold.h"

namespace alidade {

// The correction's error is of second order in these: 1e-6 rad and 1e-5 m/s after a second.
constexpr double kMaxGyroBiasShift = 1e-3;
constexpr double kMaxAccelBiasShift = 2e-2;
constexpr double kMinRotatedDepth = 1e-3;  // of a ray turned into another frame

NavState WindowFrame::nav_state() const {
  return UnpackNavState(nav.data());
}
ImuBias WindowFrame::imu_bias() const {
  return UnpackBias(bias.data());
}

void WindowTrack::ScaleInformation(double factor) {
  for (WindowView& view : views) {
    view.observation.sqrt_information *= std::sqrt(factor);
    view.root_weight_per_px *= std::sqrt(factor);
  }
}

void WindowTrack::RemoveViews(std::vector<int> indices) {
  std::sort(indices.rbegin(), indices.rend());
  for (const int index : indices) {
    views.erase(views.begin() + index);
  }
  if (anchor == nullptr && !indices.empty() && indices.back() == 0) {
    LoseBase();
  }
}

void Window::Clear() {
  frames_.clear();
  tracks_.clear();
}

WindowFrame& Window::AddFrame(std::unique_ptr<WindowFrame> frame) {
  frames_.push_back(std::move(frame));
  Renumber();
  return *frames_.back();
}

int Window::AddObservations(const CameraModel& camera, const PixelNoise& noise,
                            const std::vector<TrackObservation>& observations) {
  int invalid = 0;
  for (auto& [id, track] : tracks_) {
    track.alive = false;
  }
  for (const TrackObservation& measured : observations) {
    NormalizedObservation observation;
    const double noise_px = noise.Of(measured);
    if (!NormalizeObservation(camera, measured.pixel, noise_px, &observation)) {
      ++invalid;
      continue;
    }
    WindowTrack& track = tracks_[measured.track_id];
    if (track.alive) {  // twice in one frame: the first counts
      ++invalid;
      continue;
    }
    track.id = measured.track_id;
    track.alive = true;
    track.views.push_back({frames_.back().get(), observation, measured.pixel, 1 / noise_px});
  }
  return invalid;
}

WindowView Renormalized(const WindowCalibration& calibration, const WindowView& view) {
  WindowView seen = view;
  if (calibration.layout.intrinsics() >= 0) {
    static_cast<void>(RenormalizeObservation(calibration.mean.camera, view.pixel, 1 / view.root_weight_per_px,
                                             &seen.observation));
  }
  return seen;
}

const std::vector<WindowView>& Renormalized(const WindowCalibration& calibration,
                                            const CameraCalibration& of_views,
                                            const std::vector<WindowView>& views,
                                            std::vector<WindowView>* scratch) {
  if (calibration.layout.intrinsics() < 0 || calibration.mean == of_views) {
    return views;
  }
  scratch->clear();
  for (const WindowView& view : views) {
    scratch->push_back(Renormalized(calibration, view));
  }
  return *scratch;
}

void UpdateRates(WindowFrame* frame) {
  const Eigen::Vector3d bias = frame->imu_bias().gyro;
  const NavState nav = frame->nav_state();
  frame->motion = MotionOf(frame->turn.value_or(MeasuredTurn{bias}), bias, nav.R_WB, nav.v_WB);
  frame->rates = BodyRates(frame->motion.omega_B, nav.v_WB);
}

void Window::UpdateRates() {
  for (const std::unique_ptr<WindowFrame>& frame : frames_) {
    alidade::UpdateRates(frame.get());
  }
}

void Window::Renormalize(const WindowCalibration& calibration) {
  for (auto& [id, track] : tracks_) {
    for (WindowView& view : track.views) {
      view = Renormalized(calibration, view);
    }
  }
}

std::unique_ptr<WindowFrame> Window::RemoveNewest() {
  std::unique_ptr<WindowFrame> frame = std::move(frames_.back());
  frames_.pop_back();
  for (auto& [id, track] : tracks_) {
    if (!track.views.empty() && track.views.back().frame == frame.get()) {
      track.views.pop_back();
      track.has_landmark = track.has_landmark && (track.anchor != nullptr || !track.views.empty());
    }
  }
  return frame;
}

void Window::RemoveOldest() {
  const WindowFrame* oldest = frames_.front().get();
  for (auto& [id, track] : tracks_) {
    if (!track.views.empty() && track.views.front().frame == oldest) {
      track.views.erase(track.views.begin());
      if (track.anchor == nullptr) {
        track.LoseBase();
      }
    }
  }
  frames_.erase(frames_.begin());
  frames_.front()->imu.clear();
  frames_.front()->preintegration.reset();
  Renumber();
}

void Window::Prune() {
  std::erase_if(tracks_, [](const auto& item) {
    const WindowTrack& track = item.second;
    return !track.alive && track.anchor == nullptr && track.views.size() < 2;
  });
}

void Window::Renumber() {
  for (size_t i = 0; i < frames_.size(); ++i) {
    frames_[i]->index = static_cast<int>(i);
  }
}

FrameParallax ComputeParallax(const Window& window, const WindowFrame& first, const WindowFrame& second,
                              const Pose& T_BC) {
  const Eigen::Matrix3d R_first_second =
      (first.nav_state().R_WB * T_BC.rotation).transpose() * second.nav_state().R_WB * T_BC.rotation;
  FrameParallax parallax;
  double sum = 0;
  for (const auto& [id, track] : window.tracks()) {
    const WindowView* in_first = nullptr;
    const WindowView* in_second = nullptr;
    for (const WindowView& view : track.views) {
      in_first = view.frame == &first ? &view : in_first;
      in_second = view.frame == &second ? &view : in_second;
    }
    if (in_first == nullptr || in_second == nullptr) {
      continue;
    }
    const Eigen::Vector3d rotated = TurnedRay(R_first_second, in_second->observation.Ray());
    Eigen::Vector2d compensated;
    if (ProjectToPlane(in_first->observation.plane, rotated, kMinRotatedDepth, &compensated)) {
      sum += (compensated - in_first->observation.z).norm();
      ++parallax.common;
    }
  }
  parallax.mean = parallax.common > 0 ? sum / parallax.common : 0.0;
  return parallax;
}

void MoveMeasurements(WindowFrame* dropped, WindowFrame* frame) {
  const auto move = [&](auto* from, auto* to) {
    for (auto& measurement : *from) {
      measurement.Prepend(dropped->imu, frame->imu_bias(), dropped->preintegration->noise());
      to->push_back(std::move(measurement));
    }
    from->clear();
  };
  move(&dropped->epochs, &frame->epochs);
  move(&dropped->measurements, &frame->measurements);
}

void UpdatePreintegration(const WindowFrame& previous, const ImuNoise& noise, WindowFrame* frame) {
  const ImuBias bias = previous.imu_bias();
  if (frame->preintegration && (frame->preintegration->bias().gyro - bias.gyro).norm() < kMaxGyroBiasShift &&
      (frame->preintegration->bias().accel - bias.accel).norm() < kMaxAccelBiasShift) {
    return;
  }
  frame->preintegration.emplace(bias, noise);
  frame->preintegration->Add(frame->imu);
}

}  // namespace alidade
