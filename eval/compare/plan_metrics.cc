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

Status ReadAssociation(const PlanReader& reader, const Node& node, AssociationMethod* method) {
  std::string name;
  ALIDADE_RETURN_IF_ERROR(reader.Text(node, "association", &name));
  const std::optional<AssociationMethod> known = ParseAssociationMethod(name);
  if (!known) {
    return reader.Fault(node, "association", "alidade, evo or rpg");
  }
  *method = *known;
  return Status::Ok();
}

}  // namespace

Status ReadAlignment(const PlanReader& reader, const Node& node, Alignment* alignment) {
  std::string name;
  ALIDADE_RETURN_IF_ERROR(reader.Text(node, "align", &name));
  const std::optional<Alignment> known = ParseAlignment(name);
  if (!known) {
    return reader.Fault(node, "align", "none, pos, posyaw, se3 or sim3");
  }
  *alignment = *known;
  return Status::Ok();
}

Status ReadAlignShare(const PlanReader& reader, const Node& node, double* share) {
  constexpr double kLeast = 1e-3;
  return reader.Real(node, "align_share", kLeast, 1, share);
}

Status ReadMetrics(const PlanReader& reader, const Node& node, EvaluationOptions* metrics) {
  AssociationOptions& association = metrics->association;
  ALIDADE_RETURN_IF_ERROR(reader.Map(
      node, "metrics",
      {{"align", [&](const Node& n) { return ReadAlignment(reader, n, &metrics->alignment); }},
       {"align_share", [&](const Node& n) { return ReadAlignShare(reader, n, &metrics->align_share); }},
       {"rpe", [&](const Node& n) { return ReadDistances(reader, n, &metrics->rpe_distances_m); }},
       {"association", [&](const Node& n) { return ReadAssociation(reader, n, &association.method); }},
       {"max_dt",
        [&](const Node& n) { return reader.Real(n, "max_dt", 0, kMaxSeconds, &association.max_dt_s); }},
       {"anchor_at_first",
        [&](const Node& n) { return reader.Boolean(n, "anchor_at_first", &metrics->anchor_at_first); }},
       {"interpolate",
        [&](const Node& n) { return reader.Boolean(n, "interpolate", &association.interpolate); }},
       {"max_gap",
        [&](const Node& n) { return reader.Real(n, "max_gap", 0, kMaxSeconds, &association.max_gap_s); }}}));
  if (!node["max_dt"]) {
    association.max_dt_s = DefaultMaxDt(association.method);
  }
  if (association.interpolate && association.method != AssociationMethod::kAlidade) {
    return reader.Fault(node["interpolate"], "interpolate", "association: alidade, which alone interpolates");
  }
  return Status::Ok();
}

}  // namespace alidade
