#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// Bytes in a file without a name, which the system removes with the object or the process, however it ends.
/// Appended at the end, and read at any place. What is appended stays in memory up to kBuffer bytes, so that
/// little data never reaches the disk.
class SpoolFile {
 public:
  static constexpr std::size_t kBuffer = std::size_t{1} << 20;

  /// On the file system of `folder`, which must exist.
  explicit SpoolFile(std::string folder) : folder_(std::move(folder)) {}
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;

  /// kOutput: the folder cannot be written to, or the disk is full.
  Status Append(std::string_view bytes);
  [[nodiscard]] std::uint64_t size() const { return written_ + buffer_.size(); }
  /// Puts at most `count` bytes from `at` on into `bytes`: fewer only at the end. kOutput: they cannot be
  /// read.
  Status Read(std::uint64_t at, std::size_t count, std::string* bytes) const;

 private:
  Status Open();
  Status Flush();

  std::string folder_;
  int descriptor_ = -1;
  std::uint64_t written_ = 0;
  std::string buffer_;
};

/// The nearest folder above `path`, or it itself, that exists: where files for an output may be put before
/// its folder is made.
[[nodiscard]] std::string NearestFolder(const std::string& path);

}  // namespace alidade
