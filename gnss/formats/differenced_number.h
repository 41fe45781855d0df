#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace alidade {

/// A number of Compact RINEX, given as n-th differences in time, in units of its last decimal
/// (gnss/formats/compact_rinex.h names the source).
class DifferencedNumber {
 public:
  /// "3&value" begins an arc of order 3, "value" continues one, "" is missing and ends it. False: ill-formed.
  bool Apply(std::string_view text);

  [[nodiscard]] bool present() const { return order_ >= 0; }
  /// Right-aligned in `width`, as Fortran's F format.
  [[nodiscard]] std::string Text(int width, int decimals) const;

 private:
  static constexpr int kMaxOrder = 9;

  int order_ = -1;
  int known_ = 0;
  std::array<std::int64_t, kMaxOrder + 1> differences_{};
};

/// A text given by what changed: ' ' keeps a character, '&' blanks it.
void ApplyTextDifference(std::string_view change, std::string* text);

}  // namespace alidade
