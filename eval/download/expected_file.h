#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/status.h"

namespace alidade {

/// What the publisher states of a file; what is not stated is not checked.
struct ExpectedFile {
  std::optional<std::uint64_t> bytes;
  std::string sha256;  ///< lower-case hexadecimal; empty: not stated
  std::string md5;     ///< likewise

  [[nodiscard]] bool States() const { return bytes || !sha256.empty() || !md5.empty(); }
};

/// Ok when the file at `path` has all that is stated. Errors (kInput): the path, what was found, what was
/// expected.
Status CheckFile(const std::string& path, const ExpectedFile& expected);

}  // namespace alidade
