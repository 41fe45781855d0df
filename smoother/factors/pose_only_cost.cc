#include "smoother/factors/pose_only_cost.h"

#include <limits>
#include <utility>

#include "core/reprojection.h"
#include "smoother/tracks/track_landmark.h"

namespace alidade {
namespace {

constexpr int kMaxLandmarkIterations = 30;
// Squared whitened residual of a track whose landmark falls behind a view, so that the solver refuses such a
// step. Not larger: the tolerance of the solver is relative to the whole cost.
constexpr double kBehindChiSquare = 1e4;
// By how much a joint step may raise the cost of a track before its landmark is solved for: the solver's
// trust region, which shortens the steps of the states, does not hold those of the landmarks.
constexpr double kLargestRise = 1;

/// A point of the world in its coordinates in the base as that has moved. False: no longer in front of it.
bool FollowBase(const Pose& before, const Pose& now, const BearingPlane& plane, Eigen::Vector3d* landmark) {
  const Eigen::Vector3d q = plane.InAxes(AnchoredPointInCamera(before, now, *landmark, plane).q);
  Eigen::Vector2d bearing;
  if (!ProjectToPlane(q, kMinScaledDepth, &bearing)) {
    return false;
  }
  *landmark << bearing, landmark->z() / q.z();
  return true;
}

}  // namespace

PoseOnlyCost::PoseOnlyCost(const Window& window, std::vector<const WindowTrack*> tracks,
                           const WindowCalibration& calibration, const ObservationKernel& kernel,
                           LandmarkMotion motion)
    : window_(&window),
      calibration_(&calibration),
      tracks_(std::move(tracks)),
      kernel_(kernel),
      motion_(motion) {}

PoseOnlyCost::Step PoseOnlyCost::StepFromLinearization() const {
  Step step;
  if (linear_.tracks.empty()) {
    return step;
  }
  for (size_t i = 0; i < point_.states.size(); ++i) {
    step.poses.push_back(
        Local(ErrorConvention::kSo3xRn, linear_.point.states[i].T_WB(), point_.states[i].T_WB()));
  }
  step.calibration = Local(calibration_->layout, linear_.point.camera, point_.camera);
  return step;
}

Eigen::Vector3d PoseOnlyCost::JointStep(const EliminatedLandmark& landmark, std::span<const WindowView> views,
                                        const Step& step) {
  Eigen::Vector3d sum = landmark.gradient;
  for (size_t k = 0; k < views.size(); ++k) {
    sum.noalias() += landmark.poses[k].transpose() * step.poses[static_cast<size_t>(views[k].frame->index)];
  }
  sum.noalias() += landmark.calibration.transpose() * step.calibration;
  return -landmark.root * sum;
}

bool PoseOnlyCost::SolveTrack(size_t track, std::span<const WindowView> views, Eigen::Vector3d* landmark,
                              double* cost) const {
  return SolveLandmark(views, geometry_, kernel_, kMaxLandmarkIterations, landmark,
                       tracks_[track]->depth_prior, cost);
}

bool PoseOnlyCost::MoveTrack(size_t track, std::span<const WindowView> views, const Step& step,
                             Eigen::Vector3d* landmark, double* cost) const {
  double most = std::numeric_limits<double>::infinity();
  Eigen::Vector3d moved = *landmark;
  if (!linear_.tracks.empty() && linear_.tracks[track]) {
    const LinearTrack& linear = *linear_.tracks[track];
    *landmark = linear.landmark;
    moved = linear.landmark + JointStep(linear.eliminated, views, step);
    FrameGeometry before;
    FrameGeometry now;
    if (!FollowBase(AtRow(linear_.geometry, views.front(), &before).T_WC,
                    AtRow(geometry_, views.front(), &now).T_WC, views.front().observation.plane, &moved)) {
      return SolveTrack(track, views, landmark, cost);
    }
    most = linear.cost + kLargestRise;
  }
  if (!SolveLandmark(views, geometry_, kernel_, 1, &moved, tracks_[track]->depth_prior, cost) ||
      *cost > most) {
    return SolveTrack(track, views, landmark, cost);
  }
  *landmark = moved;
  return true;
}

double PoseOnlyCost::Solve(const WindowPoint& point) {
  point_ = point;
  camera_ = {calibration_->layout, point.camera};
  system_.reset();
  geometry_.clear();
  for (size_t i = 0; i < point.states.size(); ++i) {
    geometry_.push_back(MakeGeometry(window_->frame(static_cast<int>(i)), point.states[i], point.camera));
  }
  landmarks_.assign(tracks_.size(), std::nullopt);
  const bool joint = motion_ == LandmarkMotion::kJointStep;
  const Step step = StepFromLinearization();
  double total = 0;
  std::vector<WindowView> renormalized;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const std::span<const WindowView> views =
        Renormalized(camera_, calibration_->mean, tracks_[i]->views, &renormalized);
    Eigen::Vector3d landmark = tracks_[i]->landmark;
    double cost = 0;
    if (joint ? MoveTrack(i, views, step, &landmark, &cost) : SolveTrack(i, views, &landmark, &cost)) {
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
    const bool joint = motion_ == LandmarkMotion::kJointStep;
    if (joint) {
      linear_.point = point_;
      linear_.geometry = geometry_;
      linear_.tracks.resize(tracks_.size());
    }
    std::vector<WindowView> renormalized;
    for (size_t i = 0; i < tracks_.size(); ++i) {
      // A landmark that its views do not determine gives no rows.
      const bool rows =
          landmarks_[i] &&
          AddTrack(Renormalized(camera_, calibration_->mean, tracks_[i]->views, &renormalized), geometry_,
                   kernel_, *landmarks_[i], &workspace_, &*system_, tracks_[i]->depth_prior);
      if (rows) {
        used_.push_back(tracks_[i]);
      }
      if (joint && rows) {
        linear_.tracks[i] = {*landmarks_[i], workspace_.robust_cost, workspace_.eliminated};
      } else if (joint) {
        linear_.tracks[i].reset();
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
