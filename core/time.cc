#include "core/time.h"

#include <cstdio>

namespace alidade {

std::string FormatSeconds(TimeNs stamp_ns) {
  const bool negative = stamp_ns < 0;
  const std::uint64_t magnitude = negative ? std::uint64_t{0} - static_cast<std::uint64_t>(stamp_ns)
                                           : static_cast<std::uint64_t>(stamp_ns);
  char text[40];
  std::snprintf(text, sizeof text, "%s%llu.%09llu", negative ? "-" : "",
                static_cast<unsigned long long>(magnitude / 1'000'000'000ULL),
                static_cast<unsigned long long>(magnitude % 1'000'000'000ULL));
  return text;
}

}  // namespace alidade
