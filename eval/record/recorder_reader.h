#pragma once

#include <string>

#include "core/status.h"
#include "eval/record/recorder.h"
#include "eval/record/run_result.h"

namespace alidade {

/// What WriteRun wrote, read back: states (rotations to rounding), pose covariances, timing, statistics and
/// status. kInput: the folder holds no complete run, or a file is not as written.
Result<RunResult> ReadRun(const std::string& folder);

/// True when `folder` holds a complete run of this identity that neither was interrupted nor failed for want
/// of input.
[[nodiscard]] bool HoldsRun(const std::string& folder, const RunIdentity& identity);

}  // namespace alidade
