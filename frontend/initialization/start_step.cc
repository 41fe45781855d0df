// Where the landmarks of the least-squares problem of the start begin, and trial steps of states and
// landmarks.

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/landmark_solver.h"
#include "core/robust.h"
#include "frontend/initialization/start_problem.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kStartDepthM = 5.0;
constexpr double kMaxStartDepthM = 100.0;
constexpr int kLandmarkIterations = 3;
// Of a landmark's own rows: a depth that they do not determine.
constexpr double kMinPivotRatio = 1e-6;

}  // namespace

void StartProblem::InitializeLandmarks() {
  for (size_t t = 0; t < tracks_.size(); ++t) {
    if (!active_[t]) {
      continue;
    }
    const SharedTrack& track = tracks_[t];
    const std::vector<Pose> cameras = Cameras(current_, track);
    PoseOnlyDepth depth;
    const bool found = ComputePoseOnlyDepth(cameras, track.observations, 0, DepthViews::kMulti, &depth);
    const double start = found && depth.depth > 0 ? std::min(depth.depth, kMaxStartDepthM) : kStartDepthM;
    Vector3d& landmark = current_.landmarks[t];
    landmark = cameras.front() * (start * track.observations.front().Ray());
    // When it cannot be refined it keeps its start and the kernel weights it.
    static_cast<void>(RefineLandmark(cameras, track.observations, 2 * kLandmarkIterations, &landmark));
  }
}

bool StartProblem::StepLandmark(size_t t, const Eigen::VectorXd& step, Vector3d* landmark) const {
  const LandmarkRows& rows = landmark_rows_[t];
  const Vector3d pivots = rows.R.diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > kMinPivotRatio * pivots.maxCoeff())) {
    return false;
  }
  Vector3d right = rows.rhs;
  for (size_t k = 0; k < tracks_[t].frames.size(); ++k) {
    right += rows.jacobian.middleCols<6>(6 * static_cast<Eigen::Index>(k)) *
             step.segment<6>(15 * tracks_[t].frames[k]);
  }
  *landmark = current_.landmarks[t] - rows.R.triangularView<Eigen::Upper>().solve(right);
  return true;
}

double StartProblem::TryStep(double damping) {
  Eigen::MatrixXd damped = information_;
  damped.bottomRightCorner<15, 15>() += gauge_;
  damped.diagonal() *= 1 + damping;
  const Eigen::LLT<Eigen::MatrixXd> factor(damped);
  if (factor.info() != Eigen::Success) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::VectorXd step = factor.solve(-gradient_);
  trial_ = current_;
  for (size_t k = 0; k < trial_.states.size(); ++k) {
    const Eigen::Index at = 15 * static_cast<Eigen::Index>(k);
    trial_.states[k] = Retract(ErrorConvention::kSo3xRn, current_.states[k], step.segment<9>(at));
    trial_.biases[k].gyro += step.segment<3>(at + 9);
    trial_.biases[k].accel += step.segment<3>(at + 12);
  }
  double cost = InertialCost(trial_) + PriorCost(trial_);
  for (size_t t = 0; t < active_.size(); ++t) {
    if (!active_[t]) {
      continue;
    }
    // The landmark starts from its part of the step, which may double the scale, or, where that is no better
    // (a depth hardly known), from its place in its first camera; then it follows its own optimum.
    const SharedTrack& track = tracks_[t];
    const std::vector<Pose> cameras = Cameras(trial_, track);
    const Pose before = current_.states[static_cast<size_t>(track.frames.front())].T_WB() * settings_.T_BC;
    Vector3d& landmark = trial_.landmarks[t];
    landmark = cameras.front() * (before.Inverse() * current_.landmarks[t]);
    Vector3d stepped;
    if (StepLandmark(t, step, &stepped)) {
      const double kept_cost = TrackCost(trial_, t);
      std::swap(landmark, stepped);
      if (!(TrackCost(trial_, t) < kept_cost)) {
        std::swap(landmark, stepped);
      }
    }
    std::vector<NormalizedObservation> weighted = track.observations;
    std::vector<double> squared;
    TrackResiduals(current_, t, &squared);
    for (size_t k = 0; k < weighted.size(); ++k) {
      weighted[k].sqrt_information *=
          std::sqrt(RobustWeight(RobustKernel::kCauchy, kCauchyScale, squared[k]));
    }
    static_cast<void>(RefineLandmark(cameras, weighted, kLandmarkIterations, &landmark));
    cost += TrackCost(trial_, t);
  }
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

void StartProblem::AcceptStep() {
  std::swap(current_, trial_);
}

}  // namespace alidade
