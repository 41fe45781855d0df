#pragma once

#include <vector>

#include "core/status.h"
#include "eval/metrics/evaluation_tool.h"
#include "eval/metrics/state_pair.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// How truth and estimate rows become pairs. Nearest: pairs within max_dt_s (stamps that differ by exactly
/// that are compared as doubles of seconds, as evo and the rpg tools do), nearest first, one to one, never
/// crossing in time. Interpolated: truth at each estimate stamp (position, velocity, biases linear, rotation
/// geodesic) between rows at most max_gap_s apart, never over longer gaps nor past the ends; max_dt_s is not
/// used.
struct AssociationOptions {
  EvaluationTool method = EvaluationTool::kAlidade;
  double max_dt_s = 0.01;
  /// Added to the stamps of the estimate, so that they are in the clock of the truth [s].
  double time_offset_s = 0;
  bool interpolate = false;  ///< only with kAlidade
  double max_gap_s = 0.1;
};
/// Pairs in the order of the estimate, which is time order but for truth rows of rpg that cross. Errors:
/// fewer than 3 pairs are kInput, with both time ranges [s], the match count and a hint (wrong time unit, a
/// constant offset, the tolerance that would match); a tolerance that is negative, not finite or above 1e9 s,
/// a time offset beyond +-1e9 s, or interpolation by another method is kUsage.
Result<std::vector<StatePair>> Associate(const Trajectory& truth, const Trajectory& estimate,
                                         const AssociationOptions& options);

}  // namespace alidade
