#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// MD5 only where another program demands it, or its publisher states nothing better of an archive.
enum class HashKind { kSha256, kMd5 };

/// Collects bytes into one digest.
class Hash {
 public:
  explicit Hash(HashKind kind = HashKind::kSha256);
  ~Hash();
  Hash(const Hash&) = delete;
  Hash& operator=(const Hash&) = delete;

  void Add(std::string_view bytes);
  /// Lower-case hexadecimal digits, 64 of SHA-256 and 32 of MD5. Call once, last.
  [[nodiscard]] std::string Hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string HashHex(std::string_view bytes, HashKind kind);
[[nodiscard]] std::string Sha256Hex(std::string_view bytes);
/// Of a file's content. kInput: the file cannot be read.
Result<std::string> HashOfFile(const std::string& path, HashKind kind = HashKind::kSha256);

/// Digest of every file below a folder: relative names and contents, in the order of the names; of a file (a
/// bag): its content. kInput: a file cannot be read.
Result<std::string> DigestOfFolder(const std::string& folder);

}  // namespace alidade
