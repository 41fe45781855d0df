#pragma once

#include <memory>
#include <span>
#include <vector>

#include "smoother/factors/slam_prior.h"
#include "smoother/manifold/lifted_cost.h"

namespace alidade {

/// SlamPrior as one factor, handed over as the square root of its normal equations and one last row with the
/// rest of the cost, as PoseOnlyFactor does (all of it without Jacobians). Blocks: nav and bias of the first
/// frame, nav of the others, clock of the first in an aligned window, calibration where it is estimated.
class SlamPriorFactor {
 public:
  static constexpr int kRows = Eigen::Dynamic;

  /// `prior` must outlive the factor.
  SlamPriorFactor(const SlamPrior* prior, int frames);

  [[nodiscard]] int rows() const { return static_cast<int>(prior_->columns().size()) + 1; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return blocks_; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  struct Memo {  // as in PoseOnlyFactor
    std::vector<double> parameters;
    WindowPoint point;
    Eigen::VectorXd landmarks;
    double robust_cost = 0;
    bool solved = false;  ///< the landmarks have a solution
    bool linear = false;  ///< jacobian and residual are of these parameters
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd residual;
  };
  /// False when the calibration block is no camera.
  bool SolveLandmarks(const double* const* parameters) const;
  void Linearize() const;

  const SlamPrior* prior_;
  std::vector<BlockKind> blocks_;
  std::unique_ptr<Memo> memo_;
};

}  // namespace alidade
