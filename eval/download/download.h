#pragma once

#include <atomic>

#include "core/status.h"
#include "eval/download/download_request.h"

namespace alidade {

/// Fetches into `path`.part, checks what is expected, renames. Nothing is fetched when `path` is there and as
/// expected. A .part of before is continued by a range request; a server that answers with the whole file
/// (200) instead of the range, or with another range, is read from its beginning. A .part that is complete
/// but not as expected is removed, so that the next call begins anew; after any other failure it stays, to be
/// continued. `stop` (may be null) ends the transfer between two pieces.
///
/// Errors: kInput: `path` is there but not as expected; the server refuses (its code), offers another size
/// than expected, cannot be reached, or the connection ends early `attempts` times; what came is not as
/// expected. kOutput: the file cannot be written. kUsage: a URL that is neither http nor https.
Status Download(const DownloadRequest& request, const DownloadProgress& progress = nullptr,
                const std::atomic<bool>* stop = nullptr);

}  // namespace alidade
