#pragma once

#include "eval/compare/plan.h"
#include "eval/compare/plan_reader.h"

namespace alidade {

/// The section `metrics` of a plan, into its metrics and `interpolate`. Errors: those of PlanReader.
Status ReadMetrics(const PlanReader& reader, const YAML::Node& node, Plan* plan);
/// none, pos, posyaw, se3 or sim3.
Status ReadAlignment(const PlanReader& reader, const YAML::Node& node, TrajectoryAlignment* alignment);
Status ReadAlignShare(const PlanReader& reader, const YAML::Node& node, double* share);

}  // namespace alidade
