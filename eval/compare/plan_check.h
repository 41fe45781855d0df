#pragma once

#include "eval/compare/plan.h"
#include "eval/files/strict_yaml.h"

namespace alidade {

/// What of a plan shows only once all of it has been read; `root` is its file, for places in messages.
/// Errors: a name that no sequence has (kConfig); none of the sequences is there (kInput).
Status CheckPlan(const Plan& plan, const YAML::Node& root);

}  // namespace alidade
