#include "eval/dataset/stamp_unit.h"

#include <array>
#include <cmath>

#include "core/format.h"
#include "eval/dataset/sensor_table.h"

namespace alidade {
namespace {

constexpr std::array<StampUnit, 3> kUnits = {{{"us", 1000}, {"ms", 1'000'000}, {"s", kSecondNs}}};

}  // namespace

const StampUnit* OtherStampUnit(TimeNs first, TimeNs last, std::size_t count, double stated_rate_hz,
                                const RateLimits& limits) {
  constexpr std::size_t kLeastStamps = 11;  // fewer are no rate
  constexpr double kMostOff = 0.2;          // from the sheet's rate
  const double rate_hz = MeasuredRate(first, last, count);
  const auto is_stated = [stated_rate_hz](double hz) {
    return stated_rate_hz > 0 && std::abs(hz / stated_rate_hz - 1) < kMostOff;
  };
  if (count < kLeastStamps || !(rate_hz > limits.high_hz) || is_stated(rate_hz)) {
    return nullptr;
  }
  const auto find = [&](auto fits) -> const StampUnit* {
    for (const StampUnit& unit : kUnits) {
      if (fits(rate_hz / static_cast<double>(unit.ns))) {
        return &unit;
      }
    }
    return nullptr;
  };
  const StampUnit* by_sheet =
      find([&](double hz) { return stated_rate_hz <= limits.high_hz && is_stated(hz); });
  return by_sheet != nullptr ? by_sheet
                             : find([&](double hz) { return hz > limits.unit_hz && hz <= limits.high_hz; });
}

const StampUnit* UnitByReference(TimeNs first, TimeNs reference_ns) {
  constexpr double kMostOff = 0.01;
  for (const StampUnit& unit : kUnits) {
    const double ratio =
        static_cast<double>(first) * static_cast<double>(unit.ns) / static_cast<double>(reference_ns);
    if (std::abs(ratio - 1) < kMostOff) {
      return &unit;
    }
  }
  return nullptr;
}

std::string DateText(TimeNs first, const StampUnit& unit) {
  constexpr double kYearS = 365.2425 * 86400;
  const double year =
      1970 + static_cast<double>(first) * static_cast<double>(unit.ns) * kNsToSeconds / kYearS;
  return year >= 1990 && year < 2100 ? Format(" (the first, %lld, is then a date of %.0f)",
                                              static_cast<long long>(first), std::floor(year))
                                     : "";
}

}  // namespace alidade
