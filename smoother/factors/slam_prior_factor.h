#pragma once

#include <memory>
#include <span>
#include <vector>

#include "smoother/factors/slam_prior.h"
#include "smoother/manifold/lifted_cost.h"

namespace alidade {

/// SlamPrior as one factor, handed over as the square root of its normal equations and one last row with the
/// rest of the cost, as PoseOnlyFactor does. Blocks: nav and bias of the first frame, nav of the others,
/// clock of the first in an aligned window, calibration where it is estimated.
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
    Eigen::VectorXd landmarks;
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd residual;
  };
  /// False when the calibration block is no camera.
  bool Linearize(const double* const* parameters) const;

  const SlamPrior* prior_;
  std::vector<BlockKind> blocks_;
  std::unique_ptr<Memo> memo_;
};

}  // namespace alidade
