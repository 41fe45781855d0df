#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/estimator_config.h"
#include "eval/compare/plan.h"

namespace alidade {

/// The resolved configuration of every estimator on every sequence of a plan: a sequence may say what holds
/// on it alone, such as its pixel noise.
class CompareConfigs {
 public:
  /// Reads them all. Keeps pointers into `plan`. Errors (kConfig) name estimator and sequence.
  Status Load(const Plan& plan);

  /// Of the plan's i-th estimator; null when it is external.
  [[nodiscard]] const EstimatorConfig* Of(const PlanSequence& sequence, size_t estimator) const {
    return configs_.at(&sequence)[estimator].get();
  }

  /// The front end runs once a sequence: where it runs, all estimators must agree on its settings. Error
  /// (kConfig): they do not.
  Status CommonFrontend(const PlanSequence& sequence, FrontendConfig* common) const;

 private:
  std::map<const PlanSequence*, std::vector<std::unique_ptr<EstimatorConfig>>> configs_;
};

}  // namespace alidade
