#pragma once

#include <cstddef>
#include <string>

#include "core/time.h"
#include "eval/dataset/sensor_rates.h"

namespace alidade {

/// A unit in which files give stamps.
struct StampUnit {
  const char* name;
  TimeNs ns;
};

/// The unit of `count` stamps that were read as nanoseconds, if their mean rate is above limits.high_hz as
/// they are, and in that unit is the rate of the sheet or one above limits.unit_hz, up to limits.high_hz;
/// else null, also for fewer than eleven stamps and for stamps that have the sheet's rate as they are. The
/// mean rate, as rows that arrive in bursts have tiny median steps. stated_rate_hz: 0 without a sheet.
/// Stamps that begin at 0 are recognised by their rate like those of a date.
[[nodiscard]] const StampUnit* OtherStampUnit(TimeNs first, TimeNs last, std::size_t count,
                                              double stated_rate_hz, const RateLimits& limits);

/// The unit in which the stamp `first` is within one per cent of `reference_ns`: two clocks since 1970 whose
/// units differ. Null: none.
[[nodiscard]] const StampUnit* UnitByReference(TimeNs first, TimeNs reference_ns);

/// " (the first, 1403715273262142, is then a date of 2014)" for stamps since 1970 between 1990 and 2100;
/// empty for others.
[[nodiscard]] std::string DateText(TimeNs first, const StampUnit& unit);

}  // namespace alidade
