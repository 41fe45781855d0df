#pragma once

#include <string_view>

#include "core/time.h"

namespace alidade {

/// Decimal seconds -> integer nanoseconds, digit by digit: a double loses 0.2 us at Unix time. Digits beyond
/// the ninth decimal round to nearest. False when the text is no decimal number or beyond
/// kMaxStampNs.
bool ParseDecimalSeconds(std::string_view text, TimeNs* stamp_ns);

}  // namespace alidade
