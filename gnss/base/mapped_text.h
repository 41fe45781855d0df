#pragma once

#include <string>
#include <string_view>

#include "core/status.h"

namespace alidade {

/// The content of a text file of any size. A plain one is mapped, so that only what is being read takes
/// memory, though all of it takes address space; a gzip one is unpacked into memory (ReadTextFile). A file
/// that another process cuts short meanwhile ends this one (SIGBUS).
class MappedText {
 public:
  /// Errors (kInput): those of ReadTextFile.
  static Result<MappedText> Open(const std::string& path);
  ~MappedText();
  MappedText(MappedText&& other) noexcept;
  MappedText& operator=(MappedText&&) = delete;
  MappedText(const MappedText&) = delete;
  MappedText& operator=(const MappedText&) = delete;

  [[nodiscard]] std::string_view text() const { return mapped_.empty() ? unpacked_ : mapped_; }

 private:
  MappedText() = default;
  std::string_view mapped_;  ///< empty: in unpacked_
  std::string unpacked_;
};

}  // namespace alidade
