#pragma once

#include "smoother/factors/reduced_cost.h"
#include "smoother/factors/slam_prior.h"

namespace alidade {

/// SlamPrior as a cost. Each solution starts from the last one.
class SlamPriorCost final : public ReducedCost {
 public:
  /// `prior` must outlive the cost.
  explicit SlamPriorCost(const SlamPrior* prior);

  double Solve(const WindowPoint& point) override;
  [[nodiscard]] bool Linearize(NormalEquations* equations) override;

  /// The landmarks (3 each) at `point`, which are solved for unless the last Solve was there. Null: they have
  /// no solution.
  [[nodiscard]] const Eigen::VectorXd* LandmarksAt(const WindowPoint& point);

 private:
  const SlamPrior* prior_;
  WindowPoint point_;
  Eigen::VectorXd landmarks_;
  bool solved_ = false;  ///< the landmarks have a solution
  bool linear_ = false;  ///< the normal equations are of this point
  NormalEquations equations_;
};

}  // namespace alidade
