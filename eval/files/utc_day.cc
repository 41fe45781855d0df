#include "eval/files/utc_day.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "core/format.h"

namespace alidade {
namespace {

constexpr std::int64_t kEndOfYear9999S = 253402300799;

}  // namespace

Result<std::string> UtcDay(const char* source_date_epoch, std::chrono::system_clock::time_point now) {
  const std::string_view text = source_date_epoch == nullptr ? "" : source_date_epoch;
  if (!text.empty()) {
    std::int64_t seconds = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (error != std::errc() || end != text.data() + text.size() || seconds < 0 ||
        seconds > kEndOfYear9999S) {
      return Status::Usage("SOURCE_DATE_EPOCH: found \"" + std::string(text) +
                           "\", expected whole seconds since 1970");
    }
    now = std::chrono::system_clock::time_point(std::chrono::seconds(seconds));
  }
  const std::chrono::year_month_day day(std::chrono::floor<std::chrono::days>(now));
  return Format("%04d-%02u-%02u", static_cast<int>(day.year()), static_cast<unsigned>(day.month()),
                static_cast<unsigned>(day.day()));
}

Result<std::string> UtcDay() {
  return UtcDay(std::getenv("SOURCE_DATE_EPOCH"), std::chrono::system_clock::now());
}

}  // namespace alidade
