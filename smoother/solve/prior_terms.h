#pragma once

#include "smoother/factors/prior_factor.h"
#include "smoother/factors/slam_prior.h"
#include "smoother/factors/slam_prior_cost.h"
#include "smoother/solve/reduced_term.h"

namespace alidade {

/// A prior without landmarks. Prior and calibration must outlive the term.
[[nodiscard]] std::unique_ptr<WindowTerm> MakePriorTerm(const LinearPrior& prior,
                                                        const WindowCalibration& calibration);

/// A prior with landmarks, which it eliminates (SlamPrior).
class SlamPriorTerm final : public ReducedTerm {
 public:
  /// All must outlive the term.
  SlamPriorTerm(const LinearPrior& prior, const Window& window, const WindowCalibration& calibration,
                const ObservationKernel& kernel);

  Status Linearize(LinearTerm* linear) const override;

  /// The landmarks (3 each) that go with the present states. Null: they have no solution.
  [[nodiscard]] const Eigen::VectorXd* Landmarks() const;
  [[nodiscard]] const SlamPrior& slam() const { return slam_; }

 private:
  [[nodiscard]] ReducedCost* cost() const override { return &cost_; }

  const Window* window_;
  const WindowCalibration* calibration_;
  SlamPrior slam_;
  mutable SlamPriorCost cost_;
};

}  // namespace alidade
