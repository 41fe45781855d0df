#include "eval/evaluate.h"

#include <utility>

namespace alidade {

Result<Evaluation> Evaluate(const Trajectory& truth, const Trajectory& estimate,
                            const EvaluationOptions& options) {
  Result<std::vector<StatePair>> pairs = Associate(truth, estimate, options.association);
  if (!pairs.ok()) {
    return pairs.status();
  }
  Evaluation evaluation;
  evaluation.options = options;
  evaluation.truth_rows = truth.points.size();
  evaluation.estimate_rows = estimate.points.size();
  evaluation.pairs = std::move(pairs).value();
  if (options.anchor_at_first) {
    evaluation.pairs = ApplyAlignment(evaluation.pairs, AnchorAtFirst(evaluation.pairs));
  }
  evaluation.duration_s =
      SecondsBetween(evaluation.pairs.front().estimate.stamp_ns, evaluation.pairs.back().estimate.stamp_ns);
  evaluation.path_m = PathLength(evaluation.pairs);

  evaluation.transform = Align(evaluation.pairs, options.alignment);
  const std::vector<StatePair> aligned = ApplyAlignment(evaluation.pairs, evaluation.transform);
  evaluation.unaligned = ComputeAte(evaluation.pairs);
  evaluation.ate = ComputeAte(aligned);
  evaluation.rpe = ComputeRpe(aligned, options.rpe_distances_m);
  if (estimate.has_covariance) {
    evaluation.nees = ComputeNees(evaluation.pairs);
  }
  return evaluation;
}

}  // namespace alidade
