#pragma once

#include <compare>
#include <optional>
#include <string>

#include "gnss/base/satellite_id.h"

namespace alidade {

/// A signal as RINEX 3 names it without the observation's kind: band '1'..'9' and tracking attribute, "1C".
struct SignalCode {
  char band = '1';
  char attribute = 'C';

  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the 0 of the comparison for a pointer
  friend auto operator<=>(const SignalCode&, const SignalCode&) = default;
};

[[nodiscard]] std::string ToString(SignalCode signal);

/// Carrier frequency [Hz] (RINEX 4.00 tables 4 to 10; BeiDou B1I is band 2, B1C band 1). `glonass_channel`
/// is used by GLONASS bands 1 and 2 only; without it they have none. Nothing for an unknown band.
[[nodiscard]] std::optional<double> CarrierFrequencyHz(GnssSystem system, char band,
                                                       std::optional<int> glonass_channel);

/// What readers of older versions write otherwise: BeiDou band 1 with an attribute of B1I (RINEX 3.02) is
/// band 2.
[[nodiscard]] SignalCode CanonicalSignal(GnssSystem system, SignalCode signal, double rinex_version);

}  // namespace alidade
