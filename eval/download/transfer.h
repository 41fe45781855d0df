#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "eval/download/download_request.h"

namespace alidade {

enum class TransferOutcome {
  kComplete,     ///< the file is whole, by the length that the server gave
  kInterrupted,  ///< the connection broke or was never made: worth another attempt
  kRefused,      ///< another attempt would end likewise
};

struct TransferResult {
  TransferOutcome outcome = TransferOutcome::kInterrupted;
  Status status;            ///< not ok unless complete
  std::uint64_t total = 0;  ///< bytes of the whole file, from the server; 0: unknown
  bool continued = false;   ///< what came was appended
};

/// One HTTP request that appends to `part`, which holds the first `offset` bytes, or writes it anew where the
/// server sends the whole file. Only a body of 200 or 206 is written.
TransferResult TransferOnce(const DownloadRequest& request, const std::string& part, std::uint64_t offset,
                            const DownloadProgress& progress, const std::atomic<bool>* stop);

}  // namespace alidade
