#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "eval/download/expected_file.h"

namespace alidade {

/// One file to fetch over HTTP or HTTPS.
struct DownloadRequest {
  std::string url;
  std::string path;  ///< where it goes; its folder is made
  ExpectedFile expected;
  int attempts = 5;           ///< in succession without a byte; a connection that brought some begins anew
  long stall_timeout_s = 60;  ///< without a byte
  double pause_s = 2;         ///< before the next attempt
};

/// Bytes on disk and in total; total 0: unknown.
using DownloadProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

}  // namespace alidade
