#include "eval/dataset/imu_units.h"

#include <cmath>

namespace alidade {

const ImuUnit* NearestUnit(std::span<const ImuUnit> units, double found, double expected, double band) {
  const ImuUnit* nearest = nullptr;
  double nearest_log = std::log(band);
  for (const ImuUnit& unit : units) {
    const double off = std::abs(std::log(found / (expected * unit.per_si)));
    if (off <= nearest_log) {
      nearest = &unit;
      nearest_log = off;
    }
  }
  return nearest;
}

std::string PlausibleGyroUnits(double rate_rms, double largest_rate) {
  constexpr double kLeastOfMotion =
      0.3;  // largest rate [rad/s]; a recording in motion turns at least so fast
  std::string names;
  for (const ImuUnit& unit : std::span(kGyroUnits).subspan(1)) {
    const double largest = largest_rate / unit.per_si;
    if (rate_rms / unit.per_si <= kMostRateRms && largest <= kMostRate && largest >= kLeastOfMotion) {
      names += (names.empty() ? "" : " or ") + std::string(unit.name);
    }
  }
  return names;
}

}  // namespace alidade
