#include "smoother/factors/slam_prior_cost.h"

#include <utility>

namespace alidade {

SlamPriorCost::SlamPriorCost(const SlamPrior* prior)
    : prior_(prior), landmarks_(prior->StartingLandmarks()) {}

double SlamPriorCost::Solve(const WindowPoint& point) {
  point_ = point;
  linear_ = false;
  double cost = 0;
  Eigen::VectorXd landmarks = landmarks_;
  solved_ = prior_->SolveLandmarks(point_, &landmarks, &cost);
  if (!solved_) {
    return kRefused;
  }
  landmarks_ = std::move(landmarks);
  return cost;
}

bool SlamPriorCost::Linearize(NormalEquations* equations) {
  if (!linear_) {
    linear_ = solved_ && prior_->Linearize(point_, landmarks_, &equations_);
  }
  *equations = equations_;
  return linear_;
}

const Eigen::VectorXd* SlamPriorCost::LandmarksAt(const WindowPoint& point) {
  if (point != point_) {
    Solve(point);
  }
  return solved_ ? &landmarks_ : nullptr;
}

}  // namespace alidade
