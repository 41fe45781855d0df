#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace alidade {

/// Constellations in the order of preference as clock reference.
enum class GnssSystem : std::uint8_t { kGps, kGalileo, kBeidou, kQzss, kGlonass, kNavic, kSbas };
inline constexpr int kGnssSystems = 7;

/// A satellite by constellation and RINEX number (G01..G99; J01 is PRN 193, S20 is PRN 120).
struct SatelliteId {
  GnssSystem system = GnssSystem::kGps;
  int number = 0;

  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the 0 of the comparison for a pointer
  friend auto operator<=>(const SatelliteId&, const SatelliteId&) = default;
};

/// RINEX letter: G E C J R I S.
[[nodiscard]] char Letter(GnssSystem system);
[[nodiscard]] std::optional<GnssSystem> ParseSystem(char letter);
/// "G07", "G 7" or, in RINEX 2, " 7" (GPS). Nothing else; the number is 1..99.
[[nodiscard]] std::optional<SatelliteId> ParseSatellite(std::string_view text);
/// "G07".
[[nodiscard]] std::string ToString(SatelliteId satellite);

}  // namespace alidade
