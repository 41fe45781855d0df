#include "gnss/formats/differenced_number.h"

#include <algorithm>

#include "core/format.h"

namespace alidade {
namespace {

bool ParseInt64(std::string_view text, std::int64_t* value) {
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  if (text.size() == sign || text.size() > 19 + sign) {
    return false;
  }
  std::int64_t result = 0;
  for (const char c : text.substr(sign)) {
    if (c < '0' || c > '9' || __builtin_mul_overflow(result, std::int64_t{10}, &result) ||
        __builtin_add_overflow(result, c - '0', &result)) {
      return false;
    }
  }
  *value = sign == 1 ? -result : result;
  return true;
}

}  // namespace

bool DifferencedNumber::Apply(std::string_view text) {
  if (text.empty()) {
    order_ = -1;
    return true;
  }
  std::int64_t value = 0;
  if (text.size() > 2 && text[1] == '&') {
    if (text[0] < '0' || text[0] > '0' + kMaxOrder || !ParseInt64(text.substr(2), &value)) {
      return false;
    }
    order_ = text[0] - '0';
    known_ = 0;
    differences_.fill(0);
    differences_[0] = value;
    return true;
  }
  if (order_ < 0 || !ParseInt64(text, &value)) {
    return false;
  }
  known_ = std::min(known_ + 1, order_);
  differences_[static_cast<std::size_t>(known_)] = value;
  for (int i = known_ - 1; i >= 0; --i) {
    auto& lower = differences_[static_cast<std::size_t>(i)];
    if (__builtin_add_overflow(lower, differences_[static_cast<std::size_t>(i) + 1], &lower)) {
      return false;
    }
  }
  return true;
}

std::string DifferencedNumber::Text(int width, int decimals) const {
  const std::int64_t value = differences_[0];
  std::string digits = std::to_string(value < 0 ? std::uint64_t{0} - static_cast<std::uint64_t>(value)
                                                : static_cast<std::uint64_t>(value));
  const auto least = static_cast<std::size_t>(decimals) + 1;
  digits.insert(0, digits.size() < least ? least - digits.size() : 0, '0');
  digits.insert(digits.size() - static_cast<std::size_t>(decimals), ".");
  return Format("%*s", width, ((value < 0 ? "-" : "") + digits).c_str());
}

void ApplyTextDifference(std::string_view change, std::string* text) {
  if (text->size() < change.size()) {
    text->resize(change.size(), ' ');
  }
  for (std::size_t i = 0; i < change.size(); ++i) {
    if (change[i] != ' ') {
      (*text)[i] = change[i] == '&' ? ' ' : change[i];
    }
  }
}

}  // namespace alidade
