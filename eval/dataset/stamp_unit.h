#pragma once

#include <cstddef>
#include <limits>
#include <string>

#include "core/time.h"

namespace alidade {

/// The rates that a sensor of its kind may have [Hz].
struct RateRange {
  double least_hz = 0;
  double most_hz = 0;
};
inline constexpr RateRange kImuRates{20, 1e4};
inline constexpr RateRange kCameraRates{1, 500};
/// Of truth and position fixes, whose rates range too widely to tell a unit; UnitByReference does.
inline constexpr RateRange kAnyRates{0, std::numeric_limits<double>::infinity()};

/// A unit in which files give stamps.
struct StampUnit {
  const char* name;
  TimeNs ns;
};

/// The unit of `count` stamps that were read as nanoseconds, if their mean rate is above `range` as they are,
/// and in that unit is the rate of the sheet or one in `range`; else null, also for fewer than eleven stamps.
/// The mean rate, as rows that arrive in bursts have tiny median steps. stated_rate_hz: 0 when no sheet says
/// one. Stamps that begin at 0 are told by their rate like those of a date.
[[nodiscard]] const StampUnit* OtherStampUnit(TimeNs first, TimeNs last, std::size_t count,
                                              double stated_rate_hz, const RateRange& range);

/// The unit in which the stamp `first` is within one per cent of `reference_ns`: two clocks since 1970 whose
/// units differ. Null: none.
[[nodiscard]] const StampUnit* UnitByReference(TimeNs first, TimeNs reference_ns);

/// " (the first, 1403715273262142, is then a date of 2014)" for stamps since 1970 between 1990 and 2100;
/// empty for others.
[[nodiscard]] std::string DateText(TimeNs first, const StampUnit& unit);

}  // namespace alidade
