#include "eval/compare/plan_metrics.h"

#include <optional>
#include <string>

namespace alidade {
namespace {

using YAML::Node;

constexpr double kMaxDistance = 1e6;
constexpr double kMaxSeconds = 1e6;

Status ReadDistances(const PlanReader& reader, const Node& node, std::vector<double>* distances) {
  distances->clear();
  return reader.Each(node, "rpe", [&](const Node& entry) {
    return reader.Real(entry, "rpe", 1e-3, kMaxDistance, &distances->emplace_back());
  });
}

/// A word of a fixed set, by `parse`, which gives nothing for another one.
template <typename Choice>
Status ReadChoice(const PlanReader& reader, const Node& node, const char* key,
                  std::optional<Choice> (*parse)(std::string_view), const char* expected, Choice* choice) {
  std::string name;
  ALIDADE_RETURN_IF_ERROR(reader.Text(node, key, &name));
  const std::optional<Choice> known = parse(name);
  if (!known) {
    return reader.Fault(node, key, expected);
  }
  *choice = *known;
  return Status::Ok();
}

}  // namespace

Status ReadAlignment(const PlanReader& reader, const Node& node, TrajectoryAlignment* alignment) {
  return ReadChoice(reader, node, "align", ParseTrajectoryAlignment, "none, pos, posyaw, se3 or sim3",
                    alignment);
}

Status ReadAlignShare(const PlanReader& reader, const Node& node, double* share) {
  constexpr double kLeast = 1e-3;
  return reader.Real(node, "align_share", kLeast, 1, share);
}

Status ReadMetrics(const PlanReader& reader, const Node& node, Plan* plan) {
  EvaluationOptions* metrics = &plan->metrics;
  AssociationOptions& association = metrics->association;
  ALIDADE_RETURN_IF_ERROR(reader.Map(
      node, "metrics",
      {{"align", [&](const Node& n) { return ReadAlignment(reader, n, &metrics->alignment); }},
       {"align_share", [&](const Node& n) { return ReadAlignShare(reader, n, &metrics->align_share); }},
       {"rpe", [&](const Node& n) { return ReadDistances(reader, n, &metrics->rpe_distances_m); }},
       {"association",
        [&](const Node& n) {
          return ReadChoice(reader, n, "association", ParseEvaluationTool, "alidade, evo or rpg",
                            &association.method);
        }},
       {"max_dt",
        [&](const Node& n) { return reader.Real(n, "max_dt", 0, kMaxSeconds, &association.max_dt_s); }},
       {"anchor_at_first",
        [&](const Node& n) { return reader.Boolean(n, "anchor_at_first", &metrics->anchor_at_first); }},
       {"interpolate",
        [&](const Node& n) { return reader.Boolean(n, "interpolate", &plan->interpolate.emplace()); }},
       {"max_gap",
        [&](const Node& n) { return reader.Real(n, "max_gap", 0, kMaxSeconds, &association.max_gap_s); }}}));
  if (!node["max_dt"]) {
    association.max_dt_s = DefaultMaxDt(association.method);
  }
  if (plan->interpolate.value_or(false) && association.method != EvaluationTool::kAlidade) {
    return reader.Fault(node["interpolate"], "interpolate", "association: alidade, which alone interpolates");
  }
  return Status::Ok();
}

}  // namespace alidade
