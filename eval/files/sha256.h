#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// Collects bytes into one SHA-256 digest.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void Add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits. Call once, last.
  [[nodiscard]] std::string Hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string Sha256Hex(std::string_view bytes);

/// Digest of every file below a folder: relative names and contents, in the order of the names; of a file (a
/// bag): its content. kInput: a file cannot be read.
Result<std::string> DigestOfFolder(const std::string& folder);

}  // namespace alidade
