#pragma once

#include <string>

#include "core/status.h"
#include "eval/compare/plan.h"

namespace alidade {

/// Reads a plan. `${data}` in a path or in a setting becomes `data_root`; relative paths are relative to the
/// plan's folder. Strict: an unknown, duplicate or ill-typed key, two estimators or sequences of one name, a
/// name that is not a valid folder name, or a missing file is kConfig with file:line:column. kInput: with
/// skip_missing, all sequences are missing.
Result<Plan> ReadPlan(const std::string& path, const std::string& data_root);

}  // namespace alidade
