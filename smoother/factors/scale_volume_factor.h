#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "smoother/manifold/lifted_cost.h"

namespace alidade {

/// The cost -freedom ln(spread / present_m) of a window (SpreadOf), as one row (docs/smoother.md, The scale
/// of the start): its gradient at the present spread is exact, its curvature is next to none. Blocks: nav of
/// every frame.
class ScaleVolumeFactor {
 public:
  static constexpr int kRows = 1;

  /// point_B: the camera in the body [m].
  ScaleVolumeFactor(int frames, const Eigen::Vector3d& point_B, double present_m, double freedom);

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return blocks_; }
  /// False where the camera has not moved.
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  Eigen::Vector3d point_B_;
  double present_m_;
  double freedom_;
  std::vector<BlockKind> blocks_;
};

}  // namespace alidade
