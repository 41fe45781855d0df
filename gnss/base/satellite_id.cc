#include "gnss/base/satellite_id.h"

#include "core/format.h"

namespace alidade {
namespace {

constexpr std::string_view kLetters = "GECJRIS";

}  // namespace

char Letter(GnssSystem system) {
  return kLetters[static_cast<std::size_t>(system)];
}

std::optional<GnssSystem> ParseSystem(char letter) {
  const std::size_t found = kLetters.find(letter);
  return found == std::string_view::npos ? std::nullopt : std::optional(static_cast<GnssSystem>(found));
}

std::optional<SatelliteId> ParseSatellite(std::string_view text) {
  if (text.size() != 3) {
    return std::nullopt;
  }
  const std::optional<GnssSystem> system = text[0] == ' ' ? GnssSystem::kGps : ParseSystem(text[0]);
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (!system || !(digit(text[1]) || text[1] == ' ') || !digit(text[2])) {
    return std::nullopt;
  }
  const int number = (text[1] == ' ' ? 0 : 10 * (text[1] - '0')) + (text[2] - '0');
  return number == 0 ? std::nullopt : std::optional(SatelliteId{*system, number});
}

std::string ToString(SatelliteId satellite) {
  return Format("%c%02d", Letter(satellite.system), satellite.number);
}

}  // namespace alidade
