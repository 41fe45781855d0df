#pragma once

#include <array>
#include <span>

#include "smoother/manifold/lifted_cost.h"
#include "smoother/window/frame_fix.h"

namespace alidade {

/// A position fix as a factor over blocks nav and bias of its frame; 3 rows.
class FixFactor {
 public:
  static constexpr int kRows = PositionFixModel::kRows;

  /// `fix` must outlive the factor.
  FixFactor(const FrameFix* fix, const Eigen::Vector3d& gravity_W) : fix_(fix), gravity_W_(gravity_W) {}

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return kBlocks; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  static constexpr std::array<BlockKind, 2> kBlocks = {BlockKind::kNavState, BlockKind::kBias};
  const FrameFix* fix_;
  Eigen::Vector3d gravity_W_;
};

}  // namespace alidade
