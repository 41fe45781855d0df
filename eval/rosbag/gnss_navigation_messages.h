#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"
#include "gnss/formats/ephemeris.h"

namespace alidade {

// Further messages of gnss_comm (eval/rosbag/gnss_messages.h): ephemerides.

/// GnssEphemMsg and GnssGloEphemMsg. Times are GPST for every system. Empty for a satellite without a number.
[[nodiscard]] std::optional<std::string> EncodeEphemeris(const KeplerEphemeris& ephemeris);
[[nodiscard]] std::optional<std::string> EncodeEphemeris(const GlonassEphemeris& ephemeris);
Result<KeplerEphemeris> DecodeKeplerEphemeris(std::string_view bytes);
Result<GlonassEphemeris> DecodeGlonassEphemeris(std::string_view bytes);

}  // namespace alidade
