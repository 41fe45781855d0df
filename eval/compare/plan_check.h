#pragma once

#include "eval/compare/plan.h"
#include "eval/files/strict_yaml.h"

namespace alidade {

/// Checks of a plan that need the whole plan; `root` is its file, for positions in messages. Errors: a
/// reference to an unknown sequence (kConfig); all sequences are missing (kInput).
Status CheckPlan(const Plan& plan, const YAML::Node& root);

}  // namespace alidade
