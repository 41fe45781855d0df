#pragma once

#include <optional>

#include "smoother/factors/prior_factor.h"
#include "smoother/factors/slam_prior.h"
#include "smoother/factors/slam_prior_factor.h"
#include "smoother/solve/window_term.h"

namespace alidade {

/// A prior without landmarks. Prior and calibration must outlive the term.
[[nodiscard]] std::unique_ptr<WindowTerm> MakePriorTerm(const LinearPrior& prior,
                                                        const WindowCalibration& calibration);

/// A prior with landmarks, which it eliminates (SlamPrior).
class SlamPriorTerm final : public WindowTerm {
 public:
  /// All must outlive the term.
  SlamPriorTerm(const LinearPrior& prior, const Window& window, const WindowCalibration& calibration,
                const ObservationKernel& kernel);

  [[nodiscard]] int rows() const override { return cost_.factor().rows(); }
  /// At the states of the first call: a term is made anew once they have moved.
  Status Linearize(LinearTerm* linear) const override;
  void AddTo(ParameterBlocks* blocks, ceres::Problem* problem) override;

  /// The landmarks (3 each) that go with the present states. Null: they have no solution.
  [[nodiscard]] const Eigen::VectorXd* Landmarks() const;
  [[nodiscard]] const SlamPrior& slam() const { return slam_; }

 private:
  struct Solution {
    Eigen::VectorXd landmarks;
    SlamPrior::Reduced reduced;
    bool valid = false;
  };
  const Solution& Solve() const;

  const Window* window_;
  const WindowCalibration* calibration_;
  SlamPrior slam_;
  LiftedCost<SlamPriorFactor> cost_;
  mutable std::optional<Solution> solution_;
};

}  // namespace alidade
