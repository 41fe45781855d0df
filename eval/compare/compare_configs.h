#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/estimator_config.h"
#include "eval/compare/plan.h"

namespace alidade {

/// The resolved configuration of every estimator on every sequence of a plan: a sequence may override
/// settings for itself, such as its pixel noise.
class CompareConfigs {
 public:
  /// Reads them all. Keeps pointers into `plan`. Errors (kConfig) name estimator and sequence.
  Status Load(const Plan& plan);

  /// Of the plan's i-th estimator; null when it is external.
  [[nodiscard]] const EstimatorConfig* Of(const PlanSequence& sequence, size_t estimator) const {
    return configs_.at(&sequence)[estimator].get();
  }

  /// The front end runs once a sequence: where it runs, its settings must be equal for all estimators. Error
  /// (kConfig): they differ.
  Status CommonFrontend(const PlanSequence& sequence, FrontendConfig* common) const;

 private:
  std::map<const PlanSequence*, std::vector<std::unique_ptr<EstimatorConfig>>> configs_;
};

}  // namespace alidade
