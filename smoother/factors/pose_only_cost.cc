#include "smoother/factors/pose_only_cost.h"

#include <utility>

#include "smoother/tracks/track_landmark.h"

namespace alidade {
namespace {

constexpr int kMaxLandmarkIterations = 30;
// Squared whitened residual of a track whose landmark falls behind a view, so that the solver refuses such a
// step. Not larger: the tolerance of the solver is relative to the whole cost.
constexpr double kBehindChiSquare = 1e4;

}  // namespace

PoseOnlyCost::PoseOnlyCost(const Window& window, std::vector<const WindowTrack*> tracks,
                           const WindowCalibration& calibration, const ObservationKernel& kernel)
    : window_(&window), calibration_(&calibration), tracks_(std::move(tracks)), kernel_(kernel) {}

double PoseOnlyCost::Solve(const WindowPoint& point) {
  point_ = point;
  camera_ = {calibration_->layout, point.camera};
  system_.reset();
  geometry_.clear();
  for (size_t i = 0; i < point.states.size(); ++i) {
    geometry_.push_back(MakeGeometry(window_->frame(static_cast<int>(i)), point.states[i], point.camera));
  }
  landmarks_.assign(tracks_.size(), std::nullopt);
  double total = 0;
  std::vector<WindowView> renormalized;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const WindowTrack& track = *tracks_[i];
    Eigen::Vector3d landmark = track.landmark;
    double cost = 0;
    if (SolveLandmark(Renormalized(camera_, calibration_->mean, track.views, &renormalized), geometry_,
                      kernel_, kMaxLandmarkIterations, &landmark, track.depth_prior, &cost)) {
      landmarks_[i] = landmark;
    } else {
      cost = kBehindChiSquare;
    }
    total += cost;
  }
  return total;
}

bool PoseOnlyCost::Linearize(NormalEquations* equations) {
  if (!system_) {
    system_.emplace(window_->size(), &camera_);
    used_.clear();
    std::vector<WindowView> renormalized;
    for (size_t i = 0; i < tracks_.size(); ++i) {
      // A landmark that its views do not determine gives no rows.
      if (landmarks_[i] &&
          AddTrack(Renormalized(camera_, calibration_->mean, tracks_[i]->views, &renormalized), geometry_,
                   kernel_, *landmarks_[i], &workspace_, &*system_, tracks_[i]->depth_prior)) {
        used_.push_back(tracks_[i]);
      }
    }
  }
  *equations = {system_->hessian, system_->gradient};
  return true;
}

const PoseSystem* PoseOnlyCost::SystemAt(const WindowPoint& point) const {
  return system_ && point == point_ ? &*system_ : nullptr;
}

}  // namespace alidade
