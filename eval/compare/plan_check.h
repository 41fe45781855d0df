#pragma once

#include "eval/compare/plan.h"
#include "eval/compare/plan_reader.h"
#include "eval/files/strict_yaml.h"

namespace alidade {

/// Checks of a plan that need the whole plan; `root` is its file, for positions in messages. Errors: a
/// reference to an unknown sequence (kConfig); all sequences are missing (kInput).
Status CheckPlan(const Plan& plan, const YAML::Node& root);

/// Whether the keys of a sequence, whose node is given, go together: those of a simulation or of the format
/// of its path, which may be missing. Errors (kConfig): they do not.
Status CheckSequenceKeys(const PlanReader& reader, const YAML::Node& node, const PlanSequence& sequence);

}  // namespace alidade
