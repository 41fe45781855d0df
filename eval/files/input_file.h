#pragma once

#include <string>

#include "core/status.h"

namespace alidade {

/// The whole content of a file. Errors (`code`): the path and why it cannot be read (missing, a folder,
/// permission).
Result<std::string> ReadWholeFile(const std::string& path, StatusCode code = StatusCode::kInput);

}  // namespace alidade
