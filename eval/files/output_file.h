#pragma once

#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// Writes the whole of `content` to a temporary name beside `path` and renames it: a reader finds either the
/// complete file or none. Creates missing folders. Errors: kOutput naming the path and the system's reason.
Status WriteFileAtomically(const std::string& path, std::string_view content);

/// Removes what processes that were killed left below `folder`: temporary files of WriteFileAtomically. Only
/// for the one writer of the folder (LockFolder).
void RemoveTemporaryFiles(const std::string& folder);

/// Shortest decimal text that reads back to the same double.
[[nodiscard]] std::string ShortestDouble(double value);

}  // namespace alidade
