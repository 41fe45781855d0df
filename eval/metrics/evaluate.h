#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/metrics/metrics.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

struct EvaluationOptions {
  Alignment alignment = Alignment::kPosYaw;
  /// The alignment is fitted to this first share of the pairs; the rest shows the drift.
  double align_share = 1;
  AssociationOptions association;
  /// The estimate's world is its own: it is first moved to the truth's by AnchorAtFirst. Without it
  /// "unaligned" errors and NEES of such an estimate mean nothing.
  bool anchor_at_first = false;
  std::vector<double> rpe_distances_m = {8, 16, 24, 32, 40};
};

/// Everything that is said about one estimate against one truth.
struct Evaluation {
  EvaluationOptions options;
  std::size_t truth_rows = 0;
  std::size_t estimate_rows = 0;
  std::vector<StatePair>
      pairs;  ///< unaligned, anchored if so wished; ApplyAlignment(pairs, transform) gives the aligned ones
  double duration_s = 0;  ///< first to last pair
  double path_m = 0;      ///< truth path through the pairs
  AlignmentTransform transform;
  AteResult unaligned;
  AteResult ate;                   ///< after the alignment
  std::vector<RpeResult> rpe;      ///< after the alignment (only its scale matters here)
  std::optional<NeesResult> nees;  ///< unaligned; absent when the estimate carries no covariance
};

/// Associates, aligns and scores. When one of the two has no orientation, figures of it are NaN and there is
/// no NEES; the relative error is then that of displacements in the truth's world. Errors: those of
/// Associate; kUsage: anchor_at_first without orientation.
Result<Evaluation> Evaluate(const Trajectory& truth, const Trajectory& estimate,
                            const EvaluationOptions& options);

/// For a person: a few lines of text, six significant digits.
[[nodiscard]] std::string FormatEvaluationText(const Evaluation& evaluation);

/// For a program: one JSON object with keys in a fixed order and numbers rounded to nine significant digits
/// (the same text on every machine); what is not a number is null.
[[nodiscard]] std::string FormatEvaluationJson(const Evaluation& evaluation);

}  // namespace alidade
