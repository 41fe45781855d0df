#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// Text files are read whole; a larger one is not meant to be read as text.
inline constexpr std::size_t kMaxInputBytes = std::size_t{1} << 30;

/// The whole content of a regular file. Errors (`code`): the path and why it cannot be read (missing, not a
/// regular file, permission, larger than `max_bytes`).
Result<std::string> ReadWholeFile(const std::string& path, StatusCode code = StatusCode::kInput,
                                  std::size_t max_bytes = kMaxInputBytes);

/// No absolute path and no way up: a sequence from elsewhere must not make other files of this machine read.
[[nodiscard]] bool StaysInFolder(std::string_view name);
/// False when there is certainly nothing. True also when the system refuses to look (permission, a loop of
/// links, a name too long): whoever opens the path then gets the reason.
[[nodiscard]] bool MayExist(const std::string& path);
/// MayExist, and is not something else than a folder.
[[nodiscard]] bool MayBeFolder(const std::string& path);
/// Errors (`code`): "path: no such folder, expected <expected>", or why it cannot be entered.
Status ExpectFolder(const std::string& path, const std::string& expected,
                    StatusCode code = StatusCode::kInput);

}  // namespace alidade
