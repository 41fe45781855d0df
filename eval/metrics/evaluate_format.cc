#include "eval/metrics/evaluate_format.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/format.h"

namespace alidade {
namespace {

using Json = nlohmann::ordered_json;

/// One NEES figure with what it is compared against.
struct NeesLine {
  const char* name;
  int dof;
  double mean;
  std::size_t count;  ///< pairs with a regular covariance
  std::pair<double, double> band;
};

NeesLine MakeNeesLine(const char* name, int dof, double mean, const std::vector<double>& values) {
  const std::size_t count = static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); }));
  return {name, dof, mean, count, NeesBand(dof, static_cast<double>(count))};
}

std::vector<NeesLine> NeesLines(const NeesResult& nees) {
  return {MakeNeesLine("pose", 6, nees.mean_pose, nees.pose),
          MakeNeesLine("orientation", 3, nees.mean_orientation, nees.orientation),
          MakeNeesLine("position", 3, nees.mean_position, nees.position)};
}

/// Rounded to nine significant digits: the noise of compilers and processors stays below.
Json Number(double value) {
  if (!std::isfinite(value)) {
    return nullptr;
  }
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  const double rounded = std::strtod(text, nullptr);
  return rounded == 0 ? 0.0 : rounded;  // never "-0.0"
}

Json AteJson(const AteResult& ate) {
  return {{"pos_rmse_m", Number(ate.pos_m)},
          {"ori_rmse_deg", Number(ate.ori_deg)},
          {"pos_max_m", Number(ate.pos_max_m)}};
}

Json AlignmentJson(const Evaluation& evaluation) {
  Eigen::Quaterniond q(evaluation.transform.rotation);
  if (q.w() < 0) {
    q.coeffs() *= -1;
  }
  const Eigen::Vector3d& t = evaluation.transform.translation;
  return {{"name", std::string(ToString(evaluation.options.alignment))},
          {"q_wxyz", {Number(q.w()), Number(q.x()), Number(q.y()), Number(q.z())}},
          {"translation_m", {Number(t.x()), Number(t.y()), Number(t.z())}},
          {"scale", Number(evaluation.transform.scale)}};
}

Json RpeJson(const std::vector<RpeResult>& results) {
  Json list = Json::array();
  for (const RpeResult& rpe : results) {
    list.push_back({{"distance_m", Number(rpe.distance_m)},
                    {"count", rpe.count},
                    {"pos_rmse_m", Number(rpe.pos_rmse_m)},
                    {"ori_rmse_deg", Number(rpe.ori_rmse_deg)}});
  }
  return list;
}

Json StatisticsJson(const ErrorStatistics& statistics) {
  return {{"rmse", Number(statistics.rmse)},     {"mean", Number(statistics.mean)},
          {"median", Number(statistics.median)}, {"std", Number(statistics.std)},
          {"min", Number(statistics.min)},       {"max", Number(statistics.max)},
          {"sse", Number(statistics.sse)}};
}

Json ToolRpeJson(const Evaluation& evaluation) {
  const ToolRpeOptions& options = evaluation.options.tool_rpe;
  Json object = {{"tool", std::string(ToString(options.method))}};
  if (options.method == EvaluationTool::kEvo) {
    object["unit"] = std::string(ToString(options.unit));
    object["all_pairs"] = options.all_pairs;
    object["pairs_from_truth"] = options.pairs_from_truth;
    object["tolerance"] = Number(options.tolerance);
  } else {
    object["unit"] = "m";
  }
  object["deltas"] = Json::array();
  for (const ToolRpeResult& result : evaluation.tool_rpe) {
    Json delta = {{"delta", Number(result.delta)}, {"count", result.count}};
    for (const RelationError& relation : result.relations) {
      delta[relation.name] = StatisticsJson(relation.statistics);
      delta[relation.name]["unit"] = relation.unit;
    }
    object["deltas"].push_back(delta);
  }
  return object;
}

Json NeesJson(const NeesResult& nees, bool truth_has_covariance) {
  Json object = Json::object();
  for (const NeesLine& line : NeesLines(nees)) {
    object[line.name] = {{"mean", Number(line.mean)},
                         {"dof", line.dof},
                         {"count", line.count},
                         {"band_95", {Number(line.band.first), Number(line.band.second)}}};
  }
  object["coverage_3sigma"] = Number(nees.coverage_3sigma);
  object["truth_covariance"] = truth_has_covariance;
  return object;
}

void AppendAte(std::string& text, const std::string& name, const AteResult& ate) {
  text += Format("%-22s%14.6f%14.6f%14.6f\n", name.c_str(), ate.pos_m, ate.ori_deg, ate.pos_max_m);
}

void AppendRpe(std::string& text, const std::vector<RpeResult>& results) {
  if (!results.empty()) {
    text += Format("\n%-22s%14s%14s%14s\n", "relative error over", "rmse [m]", "rmse [deg]", "count");
  }
  for (const RpeResult& rpe : results) {
    const std::string distance = Format("%g m", rpe.distance_m);
    if (rpe.count == 0) {
      text += Format("%-22s%14s%14s%14d\n", distance.c_str(), "-", "-", 0);
    } else {
      text +=
          Format("%-22s%14.6f%14.6f%14d\n", distance.c_str(), rpe.pos_rmse_m, rpe.ori_rmse_deg, rpe.count);
    }
  }
}

/// How evo finds pairs; empty of another tool.
std::string DescribePairs(const ToolRpeOptions& options) {
  if (options.method != EvaluationTool::kEvo) {
    return "sub-trajectories";
  }
  return std::string("pairs (") + (options.all_pairs ? "all" : "consecutive") + ", along the " +
         (options.pairs_from_truth ? "truth)" : "estimate)");
}

void AppendToolRpe(std::string& text, const Evaluation& evaluation) {
  const ToolRpeOptions& options = evaluation.options.tool_rpe;
  const std::string unit(options.method == EvaluationTool::kEvo ? ToString(options.unit) : "m");
  for (const ToolRpeResult& result : evaluation.tool_rpe) {
    text +=
        Format("\nrelative error by %s over %g %s: %zu %s\n", std::string(ToString(options.method)).c_str(),
               result.delta, unit.c_str(), result.count, DescribePairs(options).c_str());
    if (result.count == 0) {
      continue;
    }
    text += Format("%-31s%13s%13s%13s%13s%13s%13s%13s\n", "", "rmse", "mean", "median", "std", "min", "max",
                   "sse");
    for (const RelationError& relation : result.relations) {
      const ErrorStatistics& s = relation.statistics;
      const std::string name = relation.name + (relation.unit.empty() ? "" : " [" + relation.unit + "]");
      text += Format("%-31s%13.6f%13.6f%13.6f%13.6f%13.6f%13.6f%13.6f\n", name.c_str(), s.rmse, s.mean,
                     s.median, s.std, s.min, s.max, s.sse);
    }
  }
}

/// The rule by which rows became pairs.
std::string DescribeAssociation(const AssociationOptions& association) {
  std::string text = association.interpolate ? Format("interpolated over at most %g s", association.max_gap_s)
                                             : Format("nearest within %g s", association.max_dt_s);
  if (association.method != EvaluationTool::kAlidade) {
    text += " by the rule of " + std::string(ToString(association.method));
  }
  if (association.time_offset_s != 0) {
    text += Format(", estimate %+g s", association.time_offset_s);
  }
  return text;
}

}  // namespace

std::string FormatEvaluationText(const Evaluation& evaluation) {
  std::string text;
  text += Format("pairs      %zu of %zu estimate and %zu truth rows (%s)\n", evaluation.pairs.size(),
                 evaluation.estimate_rows, evaluation.truth_rows,
                 DescribeAssociation(evaluation.options.association).c_str());
  text += Format("duration   %.3f s, truth path %.3f m\n", evaluation.duration_s, evaluation.path_m);
  if (evaluation.options.alignment == TrajectoryAlignment::kSim3) {
    text += Format("scale      %.6f\n", evaluation.transform.scale);
  }
  text += Format("\n%-22s%14s%14s%14s\n", "absolute error", "rmse [m]", "rmse [deg]", "max [m]");
  AppendAte(text, "unaligned", evaluation.unaligned);
  AppendAte(text, "aligned (" + std::string(ToString(evaluation.options.alignment)) + ")", evaluation.ate);

  AppendRpe(text, evaluation.rpe);
  AppendToolRpe(text, evaluation);

  if (evaluation.nees) {
    text += Format("\n%-22s%14s%14s   95 %% band for independent pairs\n", "NEES (unaligned)", "mean",
                   "expected");
    for (const NeesLine& line : NeesLines(*evaluation.nees)) {
      text += Format("%-22s%14.4f%14d   %.4f to %.4f (%zu pairs)\n", line.name, line.mean, line.dof,
                     line.band.first, line.band.second, line.count);
    }
    text += Format("%-22s%14.4f%14s\n", "inside 3 sigma", evaluation.nees->coverage_3sigma, "0.9973");
    if (evaluation.truth_has_covariance) {
      text += "NEES and 3 sigma are those of P_estimate + P_truth: the truth has a covariance\n";
    }
  }
  if (const std::string remark = RemarkOnWorld(evaluation); !remark.empty()) {
    text += "the estimate " + remark + "\n";
  }
  return text;
}

std::string FormatEvaluationJson(const Evaluation& evaluation) {
  const AssociationOptions& association = evaluation.options.association;
  Json object;
  object["pairs"] = evaluation.pairs.size();
  object["truth_rows"] = evaluation.truth_rows;
  object["estimate_rows"] = evaluation.estimate_rows;
  object["association"] = {{"rule", std::string(ToString(association.method))},
                           {"time_offset_s", Number(association.time_offset_s)},
                           {"interpolate", association.interpolate},
                           {"max_dt_s", Number(association.max_dt_s)},
                           {"max_gap_s", Number(association.max_gap_s)}};
  object["duration_s"] = Number(evaluation.duration_s);
  object["path_m"] = Number(evaluation.path_m);
  object["anchor_at_first"] = evaluation.options.anchor_at_first;
  object["align_share"] = Number(evaluation.options.align_share);
  object["alignment"] = AlignmentJson(evaluation);
  object["unaligned"] = AteJson(evaluation.unaligned);
  object["ate"] = AteJson(evaluation.ate);
  object["ate_statistics"] = {{"pos_m", StatisticsJson(evaluation.ate_pos_m)},
                              {"ori_deg", StatisticsJson(evaluation.ate_ori_deg)}};
  object["rpe"] = RpeJson(evaluation.rpe);
  if (evaluation.options.tool_rpe.method != EvaluationTool::kAlidade) {
    object["rpe_by_tool"] = ToolRpeJson(evaluation);
  }
  object["nees"] =
      evaluation.nees ? NeesJson(*evaluation.nees, evaluation.truth_has_covariance) : Json(nullptr);
  if (const std::string remark = RemarkOnWorld(evaluation); !remark.empty()) {
    object["remark"] = remark;
  }
  return object.dump(2) + "\n";
}

}  // namespace alidade
