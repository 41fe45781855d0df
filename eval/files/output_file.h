#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// Writes the whole of `content` to a temporary name beside `path` and renames it: a reader finds either the
/// complete file or none. Creates missing folders. Errors: kOutput naming the path and the system's reason.
Status WriteFileAtomically(const std::string& path, std::string_view content);

/// The same of a file beside files of others, which no command tidies up (RemoveTemporaryFiles): what killed
/// processes left of this file is removed first.
Status WriteLoneFileAtomically(const std::string& path, std::string_view content);

/// Takes the next piece of a file.
using AppendText = std::function<Status(std::string_view)>;
/// The same of a file that `write` hands over piece by piece, which ends at the first error: its own or that
/// of the file.
Status WriteFileAtomically(const std::string& path, const std::function<Status(const AppendText&)>& write);

/// Removes what processes that were killed left below `folder`: temporary files of WriteFileAtomically. Those
/// of another process that runs stay: it may write in a folder further down. Only for the one writer of the
/// folder (LockFolder).
void RemoveTemporaryFiles(const std::string& folder);

/// Shortest decimal text that reads back to the same double.
[[nodiscard]] std::string ShortestDouble(double value);

}  // namespace alidade
