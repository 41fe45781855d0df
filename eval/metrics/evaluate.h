#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/metrics/association.h"
#include "eval/metrics/error_statistics.h"
#include "eval/metrics/metrics.h"
#include "eval/metrics/nees.h"
#include "eval/metrics/state_pair.h"
#include "eval/metrics/tool_rpe.h"
#include "eval/metrics/trajectory_alignment.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

struct EvaluationOptions {
  TrajectoryAlignment alignment = TrajectoryAlignment::kPosYaw;
  /// The alignment is fitted to this first share of the pairs; the rest shows drift.
  double align_share = 1;
  AssociationOptions association;
  /// The estimate has an arbitrary yaw and origin and is first moved to the truth's world by AnchorAtFirst.
  /// Otherwise "unaligned" errors and NEES of such an estimate are not meaningful.
  bool anchor_at_first = false;
  std::vector<double> rpe_distances_m = {8, 16, 24, 32, 40};
  ToolRpeOptions tool_rpe;  ///< the relative error as evo or rpg_trajectory_evaluation define it, instead
};

/// The evaluation of one estimate against one truth.
struct Evaluation {
  EvaluationOptions options;
  std::size_t truth_rows = 0;
  std::size_t estimate_rows = 0;
  std::vector<StatePair>
      pairs;  ///< unaligned, anchored if requested; ApplyAlignment(pairs, transform) gives the aligned ones
  double duration_s = 0;  ///< first to last pair
  double path_m = 0;      ///< truth path through the pairs
  AlignmentTransform transform;
  AteResult unaligned;
  AteResult ate;                        ///< after the alignment
  ErrorStatistics ate_pos_m;            ///< of its position errors
  ErrorStatistics ate_ori_deg;          ///< of its rotation angles
  std::vector<RpeResult> rpe;           ///< after the alignment (only its scale matters here)
  std::vector<ToolRpeResult> tool_rpe;  ///< instead of `rpe`, by the method of options.tool_rpe
  std::optional<NeesResult> nees;       ///< unaligned; absent when the estimate has no covariance
  bool truth_has_covariance = false;    ///< which `nees` then includes (ErrorCovariance)

  /// Stamp of a pair in the clock of the estimate.
  [[nodiscard]] TimeNs EstimateStamp(const StatePair& pair) const {
    return pair.estimate.stamp_ns - SecondsToNs(options.association.time_offset_s);
  }
};

/// Associates, aligns and scores. When one of the two has no orientation, figures of it are NaN and there is
/// no NEES; the relative error is then that of displacements in the truth's world. Errors: those of
/// Associate and of the tool's RPE; kUsage: anchor_at_first or a tool's RPE without orientation.
Result<Evaluation> Evaluate(const Trajectory& truth, const Trajectory& estimate,
                            const EvaluationOptions& options);

/// That the estimate does not begin in the truth's world, so that "unaligned" errors and NEES are not
/// meaningful without EvaluationOptions::anchor_at_first; empty if it does, or has no covariance to tell it
/// by. It does not when yaw and offset of AnchorAtFirst are beyond 30 of the first pose's deviations, and
/// most of its NEES is gone with them.
[[nodiscard]] std::string RemarkOnWorld(const Evaluation& evaluation);

}  // namespace alidade
