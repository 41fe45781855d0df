#include "eval/compare/plan.h"

#include <algorithm>

namespace alidade {

bool PlanEstimator::RunsOn(const std::string& sequence) const {
  return trajectories.empty()
             ? sequences.empty() || std::find(sequences.begin(), sequences.end(), sequence) != sequences.end()
             : trajectories.count(sequence) > 0;
}

EvaluationOptions Plan::MetricsOf(const PlanEstimator& estimator, const PlanSequence& sequence) const {
  EvaluationOptions own = metrics;
  own.alignment = estimator.alignment.value_or(metrics.alignment);
  own.align_share = estimator.align_share.value_or(metrics.align_share);
  own.anchor_at_first = sequence.anchor_at_first.value_or(metrics.anchor_at_first);
  const bool exact_truth = !sequence.config.empty() && sequence.truth.empty();
  own.association.interpolate =
      interpolate.value_or(exact_truth && own.association.method == EvaluationTool::kAlidade);
  return own;
}

}  // namespace alidade
