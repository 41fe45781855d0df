#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "smoother/manifold/lifted_cost.h"
#include "smoother/solve/window_term.h"

namespace alidade {

/// A parameter block that a factor is over: whose it is, and where its present value stands.
struct TermBlock {
  BlockKind kind;
  int index = 0;  ///< of the frame or landmark
  const double* present = nullptr;
  Eigen::Index width = 0;  ///< tangent coordinates that are estimated, the leading ones
};
[[nodiscard]] TermBlock NavBlock(const WindowFrame& frame);
[[nodiscard]] TermBlock BiasBlock(const WindowFrame& frame);
/// Precondition: clock.
[[nodiscard]] TermBlock ClockBlock(const WindowFrame& frame);
[[nodiscard]] TermBlock LandmarkBlock(const WindowTrack& track, int landmark);
[[nodiscard]] TermBlock CalibrationBlock(const WindowCalibration& calibration);

/// The blocks of a term and where their columns stand in the tangent Jacobians of a factor. A bias that
/// follows the navigation state of its frame is one part with it.
class FactorBlocks : public WindowTerm {
 public:
  void AddTo(WindowProblem* problem) override;

 protected:
  explicit FactorBlocks(std::vector<TermBlock> blocks);

  [[nodiscard]] std::vector<const double*> Present() const;
  [[nodiscard]] virtual ceres::CostFunction* cost() = 0;
  /// Tangent Jacobians of all blocks, row-major, one after the other, to the rows of a LinearTerm.
  void Gather(const std::vector<double>& tangents, LinearTerm* linear) const;
  /// Room for such Jacobians, and where each block's begins.
  [[nodiscard]] std::vector<double*> Spread(int rows, std::vector<double>* tangents) const;

 private:
  std::vector<TermBlock> blocks_;
};

/// A Factor (smoother/manifold/lifted_cost.h) as a term of a window. `blocks`: in the order of the factor's.
template <typename Factor>
class FactorTerm final : public FactorBlocks {
 public:
  FactorTerm(Factor factor, std::vector<TermBlock> blocks)
      : FactorBlocks(std::move(blocks)), cost_(std::move(factor)) {}

  Status Linearize(LinearTerm* linear) const override {
    std::vector<double> tangents;
    const int rows = cost_.factor().rows();
    const std::vector<double*> jacobians = Spread(rows, &tangents);
    linear->ResizeRows(parts(), rows);
    if (!cost_.factor().Evaluate(Present().data(), linear->residual.data(), jacobians.data())) {
      return Status::Diverged("smoother: a factor is undefined at the present states");
    }
    Gather(tangents, linear);
    return Status::Ok();
  }
  [[nodiscard]] const ceres::CostFunction& ceres_cost() const { return cost_; }

 private:
  [[nodiscard]] ceres::CostFunction* cost() override { return &cost_; }

  LiftedCost<Factor> cost_;
};

/// `blocks`: in the order of the factor's; the last one is left out where the factor has fewer.
template <typename Factor>
[[nodiscard]] std::unique_ptr<FactorTerm<Factor>> MakeTerm(Factor factor, std::vector<TermBlock> blocks) {
  const auto used = static_cast<std::ptrdiff_t>(std::min(blocks.size(), factor.blocks().size()));
  blocks.erase(blocks.begin() + used, blocks.end());
  return std::make_unique<FactorTerm<Factor>>(std::move(factor), std::move(blocks));
}

}  // namespace alidade
