#pragma once

#include <cstdint>
#include <string>

#include "core/status.h"

namespace alidade {

/// Size [bytes] of a regular file, also through links; to be asked before it is opened, as opening a FIFO
/// blocks and a device has no end. Errors (`code`): the path, and the system's reason (missing, a loop of
/// links, a name too long, permission) or what is there instead.
Result<std::uintmax_t> RegularFileSize(const std::string& path, StatusCode code = StatusCode::kInput);

}  // namespace alidade
