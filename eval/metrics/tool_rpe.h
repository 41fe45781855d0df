#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/status.h"
#include "eval/metrics/error_statistics.h"
#include "eval/metrics/evaluation_tool.h"
#include "eval/metrics/state_pair.h"

namespace alidade {

/// What the deltas of evo count.
enum class RpeUnit { kFrames, kMetres, kDegrees, kRadians };
[[nodiscard]] std::optional<RpeUnit> ParseRpeUnit(std::string_view name);  // frames|m|deg|rad
[[nodiscard]] std::string_view ToString(RpeUnit unit);

struct ToolRpeOptions {
  EvaluationTool method = EvaluationTool::kAlidade;
  /// evo: in `unit`. rpg: lengths of sub-trajectories [m]. Empty: the tool's own, 1 frame, or the lengths of
  /// DefaultRpgLengths.
  std::vector<double> deltas;
  // The rest is of evo.
  RpeUnit unit = RpeUnit::kFrames;
  bool all_pairs = false;         ///< overlapping pairs, instead of each beginning where the last ended
  bool pairs_from_truth = false;  ///< deltas are measured along the truth, instead of along the estimate
  double tolerance = 0.1;         ///< share of the delta that a pair of all_pairs may miss it by
};

/// Statistics of one relation of the relative poses, by the tool's name of it.
struct RelationError {
  std::string name;
  std::string unit;  ///< empty: none
  ErrorStatistics statistics;
};
/// The relative error over one delta.
struct ToolRpeResult {
  double delta = 0;
  std::size_t count = 0;  ///< relative poses; 0: nothing matches the delta
  std::vector<RelationError> relations;
};

/// The RPE of evo 1.36 (evo_rpe), every pose relation. With the relative poses of truth Q and estimate P over
/// a pair, E = Q^-1 P: trans_part |t(E)| [m], rot_part |R(E) - I| (Frobenius), full |E - I| (Frobenius),
/// angle_deg and angle_rad the angle of R(E), point_distance | |t(Q)| - |t(P)| | [m],
/// point_distance_error_ratio that over |t(Q)| [%], without pairs whose truth stands still.
///
/// Pairs over a delta, along the estimate or the truth. frames: indices delta apart. m: consecutive pairs
/// end where the path since the last end reaches delta, and the first begins where it does so first; all
/// pairs start anywhere and end where the path is nearest to delta, within the tolerance. deg, rad:
/// consecutive pairs end where the sum of the angles between rows reaches delta; all pairs are those whose
/// direct angle is delta, within the tolerance.
///
/// Errors: kUsage for a delta that is not positive, a number of frames that is not whole, an angle above 180
/// degrees.
Result<std::vector<ToolRpeResult>> ComputeEvoRpe(const std::vector<StatePair>& aligned_pairs,
                                                 const ToolRpeOptions& options);

/// The relative error of rpg_trajectory_evaluation (commit 8c8ceec) over lengths [m] of the truth's path.
/// A sub-trajectory begins at a pair and ends at the later one whose path is nearest to the length, if that
/// is within 20 % of it; there are none when fewer than two are found. E = Q^-1 P, in axes of the world of
/// the estimate as it was given: trans |t(E)| [m], trans_perc that over the length [%], rot the angle of R(E)
/// [deg], yaw |yaw| and gravity sqrt(pitch^2 + roll^2) of R(E) = Rz(yaw) Ry(pitch) Rx(roll) [deg],
/// rot_deg_per_m the angle over the length. The translation of P is multiplied by `scale`, that of the
/// alignment.
///
/// Like the tool, the k-th end that is found belongs to the k-th pair as beginning: where a gap of the path
/// leaves a beginning without an end, later sub-trajectories are longer than the length.
std::vector<ToolRpeResult> ComputeRpgRelativeErrors(const std::vector<StatePair>& unaligned_pairs,
                                                    double scale, const std::vector<double>& lengths_m);

/// 10, 20, 30, 40 and 50 % of the path of the whole truth [m], cut off after centimetres, as
/// rpg_trajectory_evaluation does where no lengths are given.
[[nodiscard]] std::vector<double> DefaultRpgLengths(const Trajectory& truth);

}  // namespace alidade
