#include "eval/metrics/evaluate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/format.h"
#include "core/lie.h"
#include "core/numbers.h"

namespace alidade {
namespace {

// RemarkOnWorld: square of 30 deviations, and the largest share of the NEES that may be left.
constexpr double kOtherWorldNees = 900;
constexpr double kOtherWorldShare = 0.1;

/// The pairs with all rotations the identity: their relative errors are then those of displacements in the
/// world.
std::vector<StatePair> WithoutOrientation(std::vector<StatePair> pairs) {
  for (StatePair& pair : pairs) {
    pair.truth.nav.R_WB.setIdentity();
    pair.estimate.nav.R_WB.setIdentity();
  }
  return pairs;
}

/// At least one.
std::vector<StatePair> FirstShare(const std::vector<StatePair>& pairs, double share) {
  const double count = std::ceil(share * static_cast<double>(pairs.size()));
  return {pairs.begin(), pairs.begin() + std::max(std::ptrdiff_t{1}, static_cast<std::ptrdiff_t>(count))};
}

/// NEES of what the truth does not hold would be of zeros.
void ForgetUnknownNees(const Trajectory& truth, NeesResult* nees) {
  if (!truth.has_velocity) {
    nees->mean_velocity = kNan;
  }
  if (!truth.has_bias) {
    nees->mean_gyro_bias = nees->mean_accel_bias = kNan;
  }
}

/// The aligned pairs' errors: their statistics as evo prints them, of which the figures of `ate` are a part.
void DescribeAte(const std::vector<StatePair>& aligned, Evaluation* evaluation) {
  std::vector<double> pos_m, ori_deg;
  for (const StatePair& pair : aligned) {
    const NavState& truth = pair.truth.nav;
    const NavState& estimate = pair.estimate.nav;
    pos_m.push_back((truth.p_WB - estimate.p_WB).norm());
    ori_deg.push_back(so3::Log(estimate.R_WB.transpose() * truth.R_WB).norm() * 180 / std::numbers::pi);
  }
  evaluation->ate_pos_m = ComputeErrorStatistics(pos_m);
  evaluation->ate_ori_deg = ComputeErrorStatistics(ori_deg);
  evaluation->ate = {evaluation->ate_pos_m.rmse, evaluation->ate_ori_deg.rmse, evaluation->ate_pos_m.max};
}

Status ComputeRelativeErrors(const Trajectory& truth, const std::vector<StatePair>& aligned, bool oriented,
                             Evaluation* evaluation) {
  ToolRpeOptions& tool = evaluation->options.tool_rpe;
  if (tool.method == EvaluationTool::kAlidade) {
    evaluation->rpe =
        ComputeRpe(oriented ? aligned : WithoutOrientation(aligned), evaluation->options.rpe_distances_m);
    return Status::Ok();
  }
  if (!oriented) {
    return Status::Usage("relative errors by " + std::string(ToString(tool.method)) +
                         " need orientations, but one of the trajectories has none");
  }
  if (tool.method == EvaluationTool::kRpg) {
    if (tool.deltas.empty()) {
      tool.deltas = DefaultRpgLengths(truth);
    }
    evaluation->tool_rpe =
        ComputeRpgRelativeErrors(evaluation->pairs, evaluation->transform.scale, tool.deltas);
    return Status::Ok();
  }
  Result<std::vector<ToolRpeResult>> results = ComputeEvoRpe(aligned, tool);
  if (!results.ok()) {
    return results.status();
  }
  evaluation->tool_rpe = std::move(results).value();
  return Status::Ok();
}

void ForgetOrientation(Evaluation* evaluation) {
  evaluation->ate_ori_deg = ErrorStatistics();
  evaluation->unaligned.ori_deg = evaluation->ate.ori_deg = kNan;
  for (RpeResult& rpe : evaluation->rpe) {
    rpe.ori_rmse_deg = kNan;
  }
}

}  // namespace

Result<Evaluation> Evaluate(const Trajectory& truth, const Trajectory& estimate,
                            const EvaluationOptions& options) {
  Result<std::vector<StatePair>> pairs = Associate(truth, estimate, options.association);
  if (!pairs.ok()) {
    return pairs.status();
  }
  const bool oriented = truth.has_orientation && estimate.has_orientation;
  if (options.anchor_at_first && !oriented) {
    return Status::Usage("anchor_at_first: needs orientations, but one of the trajectories has none");
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

  evaluation.transform = Align(FirstShare(evaluation.pairs, options.align_share), options.alignment);
  const std::vector<StatePair> aligned = ApplyAlignment(evaluation.pairs, evaluation.transform);
  evaluation.unaligned = ComputeAte(evaluation.pairs);
  DescribeAte(aligned, &evaluation);
  ALIDADE_RETURN_IF_ERROR(ComputeRelativeErrors(truth, aligned, oriented, &evaluation));
  if (!oriented) {
    ForgetOrientation(&evaluation);
  } else if (estimate.has_covariance) {
    evaluation.nees = ComputeNees(evaluation.pairs);
    ForgetUnknownNees(truth, &*evaluation.nees);
    evaluation.truth_has_covariance = truth.has_covariance;
  }
  return evaluation;
}

std::string RemarkOnWorld(const Evaluation& evaluation) {
  if (!evaluation.nees || evaluation.options.anchor_at_first) {
    return "";
  }
  const std::vector<StatePair> first = {evaluation.pairs.front()};
  const AlignmentTransform anchor = AnchorAtFirst(first);
  const double nees = evaluation.nees->pose.front();
  const double anchored = ComputeNees(ApplyAlignment(first, anchor)).pose.front();
  if (!(nees > kOtherWorldNees) || anchored > kOtherWorldShare * nees) {
    return "";
  }
  const double distance_m = (first.front().truth.nav.p_WB - first.front().estimate.nav.p_WB).norm();
  const double yaw_deg = kDegreesPerRadian * so3::Log(anchor.rotation).norm();
  return Format(
      "begins %.3g m and %.3g deg of yaw from the truth: RMSE, NEES and silent failures need "
      "anchor_at_first",
      distance_m, yaw_deg);
}

}  // namespace alidade
