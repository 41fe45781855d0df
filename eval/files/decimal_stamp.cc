#include "eval/files/decimal_stamp.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>

namespace alidade {

bool ParseDecimalSeconds(std::string_view text, TimeNs* stamp_ns) {
  int exponent = 0;
  if (const size_t e = text.find_first_of("eE"); e != std::string_view::npos) {
    std::string_view digits = text.substr(e + 1);
    digits.remove_prefix(digits.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (error != std::errc() || end != digits.data() + digits.size() || std::abs(exponent) > 30) {
      return false;
    }
    text = text.substr(0, e);
  }
  const bool negative = text.starts_with('-');
  text.remove_prefix(negative ? 1 : 0);
  std::string digits;
  size_t integer_digits = text.size();
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '.' && integer_digits == text.size()) {
      integer_digits = i;
    } else if (text[i] >= '0' && text[i] <= '9') {
      digits.push_back(text[i]);
    } else {
      return false;
    }
  }
  if (digits.empty()) {
    return false;
  }
  const int kept = static_cast<int>(integer_digits) + 9 + exponent;  // digits up to the nanosecond
  std::uint64_t value = 0;
  for (int i = 0; i < kept; ++i) {
    const unsigned digit =
        i < static_cast<int>(digits.size()) ? static_cast<unsigned>(digits[static_cast<size_t>(i)] - '0') : 0;
    if (value > (static_cast<std::uint64_t>(INT64_MAX) - digit) / 10) {
      return false;
    }
    value = value * 10 + digit;
  }
  if (kept >= 0 && kept < static_cast<int>(digits.size()) && digits[static_cast<size_t>(kept)] >= '5') {
    ++value;
  }
  if (value > static_cast<std::uint64_t>(kMaxStampNs)) {
    return false;
  }
  *stamp_ns = negative ? -static_cast<TimeNs>(value) : static_cast<TimeNs>(value);
  return true;
}

}  // namespace alidade
