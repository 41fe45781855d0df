#pragma once

#include <array>
#include <span>

#include "core/preintegration.h"
#include "smoother/manifold/first_estimate.h"
#include "smoother/manifold/lifted_cost.h"

namespace alidade {

/// PreintegrationModel between two frames, whitened: blocks nav_i, bias_i, nav_j, bias_j; 15 rows.
class ImuFactor {
 public:
  static constexpr int kRows = 15;

  /// `preintegration` must outlive the factor. first_i, first_j: where Jacobians over a frame are taken, if
  /// not at its present state; they must outlive it too.
  ImuFactor(const Preintegration* preintegration, const Eigen::Vector3d& gravity_W,
            const FirstEstimate* first_i = nullptr, const FirstEstimate* first_j = nullptr);

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return kBlocks; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;
  /// False when the covariance could not be inverted (Preintegration::Whitening).
  [[nodiscard]] bool valid() const { return valid_; }

 private:
  static constexpr std::array<BlockKind, 4> kBlocks = {BlockKind::kNavState, BlockKind::kBias,
                                                       BlockKind::kNavState, BlockKind::kBias};
  PreintegrationModel model_;
  Matrix15d sqrt_information_;  // lower triangular
  bool valid_ = false;
  const FirstEstimate* first_i_;
  const FirstEstimate* first_j_;
};

}  // namespace alidade
