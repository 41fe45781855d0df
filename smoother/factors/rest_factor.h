#pragma once

#include <array>
#include <span>

#include "core/rest_model.h"
#include "smoother/manifold/lifted_cost.h"

namespace alidade {

/// RestMeasurement of one frame, whitened: blocks nav, bias; 6 rows.
class RestFactor {
 public:
  static constexpr int kRows = RestModel::kRows;

  explicit RestFactor(const RestMeasurement& measurement) : measurement_(measurement) {}

  [[nodiscard]] int rows() const { return kRows; }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return kBlocks; }
  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const;

 private:
  static constexpr std::array<BlockKind, 2> kBlocks = {BlockKind::kNavState, BlockKind::kBias};
  RestMeasurement measurement_;
};

}  // namespace alidade
