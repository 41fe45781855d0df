#include "gnss/orbits/satellite_catalog.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "gnss/base/constants.h"
#include "gnss/formats/glonass_accuracy.h"
#include "gnss/orbits/broadcast_orbit.h"
#include "gnss/orbits/precise_orbit.h"

namespace alidade {
namespace {

constexpr double kPreciseAccuracyM = 0.1;

TimeNs MaxAgeNs(GnssSystem system) {
  constexpr TimeNs kHour = 3600 * kSecondNs;
  switch (system) {
    case GnssSystem::kGalileo:
      return 4 * kHour;
    case GnssSystem::kBeidou:
      return 6 * kHour;
    case GnssSystem::kGlonass:
      return kHour / 2 + 30 * kSecondNs;
    default:
      return 2 * kHour;
  }
}

/// RINEX 3.05 table A8: of E1-B bits 0 to 2, of E5a 3 to 5, of E5b 6 to 8 (data validity, signal health).
bool GalileoHealthy(const KeplerEphemeris& e, SignalCode signal) {
  const int shift = signal.band == '5' ? 3 : (signal.band == '7' ? 6 : 0);
  const int both = signal.band == '8' ? e.health >> 3 | e.health >> 6 : e.health >> shift;
  return (both & 7) == 0;
}

bool Healthy(const KeplerEphemeris& e, SignalCode signal) {
  switch (e.satellite.system) {
    case GnssSystem::kGalileo:
      return GalileoHealthy(e, signal);
    case GnssSystem::kQzss:
      return (e.health & ~1) == 0;  // bit 0 is that of L6
    default:
      return e.health == 0;
  }
}

/// The ephemeris that is nearest in time, within the age; of equals a preferred message, then the latest.
const KeplerEphemeris* Nearest(const std::vector<KeplerEphemeris>& list, TimeNs stamp_ns, TimeNs max_age_ns) {
  const auto rank = [](const KeplerEphemeris& e) { return e.message == NavMessage::kFnav ? 1 : 0; };
  const KeplerEphemeris* best = nullptr;
  const auto from = std::lower_bound(list.begin(), list.end(), stamp_ns - max_age_ns,
                                     [](const KeplerEphemeris& e, TimeNs stamp) { return e.toe_ns < stamp; });
  for (auto e = from; e != list.end() && e->toe_ns <= stamp_ns + max_age_ns; ++e) {
    const TimeNs age = std::abs(e->toe_ns - stamp_ns);
    if (best == nullptr || rank(*e) < rank(*best) ||
        (rank(*e) == rank(*best) && age <= std::abs(best->toe_ns - stamp_ns))) {
      best = &*e;
    }
  }
  return best;
}

const GlonassEphemeris* Nearest(const std::vector<GlonassEphemeris>& list, TimeNs stamp_ns,
                                TimeNs max_age_ns) {
  const GlonassEphemeris* best = nullptr;
  for (const GlonassEphemeris& e : list) {
    const TimeNs age = std::abs(e.toe_ns - stamp_ns);
    if (age <= max_age_ns && (best == nullptr || age <= std::abs(best->toe_ns - stamp_ns))) {
      best = &e;
    }
  }
  return best;
}

double SquaredRatio(double f1, double f2) {
  return f1 * f1 / (f2 * f2);
}

constexpr double kL1 = 1575.42;
constexpr double kL5 = 1176.45;
constexpr double kE5b = 1207.14;

GroupDelay GpsDelay(const KeplerEphemeris& e, char band) {
  const double tgd = kSpeedOfLight * e.group_delay_s[0];
  switch (band) {
    case '1':
      return {tgd, 0};
    case '2':
      return {SquaredRatio(kL1, 1227.60) * tgd, 0};
    default:
      return {SquaredRatio(kL1, kL5) * tgd, 1.5};  // ISC of L5 comes with CNAV only
  }
}

GroupDelay GalileoDelay(const KeplerEphemeris& e, bool precise, char band) {
  const double a = kSpeedOfLight * e.group_delay_s[0];  // BGD(E1, E5a)
  const double b = kSpeedOfLight * e.group_delay_s[1];  // BGD(E1, E5b)
  const bool fnav_clock = precise || e.message == NavMessage::kFnav;
  const double e1 = fnav_clock ? a : b;
  const double e5a = e1 - a + SquaredRatio(kL1, kL5) * a;
  const double e5b = e1 - b + SquaredRatio(kL1, kE5b) * b;
  // F/NAV does not hold the E5b delay.
  const double missing = e.message == NavMessage::kFnav && b == 0 ? 1.5 : 0;
  switch (band) {
    case '1':
      return {e1, 0};
    case '5':
      return {e5a, 0};
    case '7':
      return {e5b, missing};
    case '8':
      return {0.5 * (e5a + e5b), 0.5 + missing};
    default:
      return {e1, 1.5};  // E6 has none
  }
}

GroupDelay BeidouDelay(const KeplerEphemeris& e, bool precise, char band) {
  constexpr double kB1 = 1561.098;
  constexpr double kB3 = 1268.52;
  const double tgd1 = kSpeedOfLight * e.group_delay_s[0];
  const double tgd2 = kSpeedOfLight * e.group_delay_s[1];
  const double clock = precise ? kB1 * kB1 / (kB1 * kB1 - kB3 * kB3) * tgd1 : 0;
  switch (band) {
    case '2':
      return {tgd1 - clock, 0};
    case '1':
      return {tgd1 - clock, 0.5};
    case '6':
      return {-clock, 0};
    case '7':
      return {tgd2 - clock, tgd2 == 0 ? 1.5 : 0};  // BeiDou-3 sends none for B2b
    default:
      return {tgd2 - clock, 1.5};
  }
}

GroupDelay GlonassDelay(const GlonassEphemeris* e, bool precise, char band) {
  const bool known = e != nullptr && e->l2_delay_s.has_value();
  const double l2 = known ? kSpeedOfLight * *e->l2_delay_s : 0;
  constexpr double kL2Share = 1 / (1 - 81.0 / 49.0);  // of L2 in the ionosphere-free pair
  const double clock = precise ? kL2Share * l2 : 0;
  const double unknown = known ? 0 : 1.5;
  constexpr double kUnknownPreciseM = 4;  // 1.53 times the delay, metres apart from satellite to satellite
  switch (band) {
    case '1':
      return {-clock, precise && !known ? kUnknownPreciseM : 0};
    case '2':
      return {l2 - clock, unknown};
    default:
      return {l2 - clock, 2};
  }
}

}  // namespace

SatelliteCatalog::SatelliteCatalog(NavigationData navigation, PreciseProducts precise)
    : navigation_(std::move(navigation)), precise_(std::move(precise)) {}

std::optional<int> SatelliteCatalog::GlonassChannel(int number) const {
  const auto found = navigation_.glonass.find(number);
  return found == navigation_.glonass.end() || found->second.empty()
             ? std::nullopt
             : std::optional(found->second.front().channel);
}

SatelliteFix SatelliteCatalog::Select(SatelliteId satellite, SignalCode signal, TimeNs stamp_ns) const {
  SatelliteFix fix;
  const TimeNs max_age = MaxAgeNs(satellite.system);
  if (satellite.system == GnssSystem::kGlonass) {
    if (const auto found = navigation_.glonass.find(satellite.number); found != navigation_.glonass.end()) {
      fix.glonass = Nearest(found->second, stamp_ns, max_age);
    }
  } else if (const auto found = navigation_.kepler.find(satellite); found != navigation_.kepler.end()) {
    fix.kepler = Nearest(found->second, stamp_ns, max_age);
  }
  if (fix.kepler == nullptr && fix.glonass == nullptr) {
    fix.fault = SatelliteFault::kNoEphemeris;
    return fix;
  }
  const bool healthy = fix.kepler != nullptr ? Healthy(*fix.kepler, signal) : fix.glonass->health == 0;
  fix.fault = healthy ? SatelliteFault::kNone : SatelliteFault::kUnhealthy;
  fix.accuracy_m = fix.kepler != nullptr ? fix.kepler->accuracy_m : kGlonassAccuracyM;
  return fix;
}

SatelliteState SatelliteCatalog::Propagate(const SatelliteFix& fix, TimeNs stamp_ns) const {
  return fix.kepler != nullptr ? PropagateKepler(*fix.kepler, stamp_ns)
                               : PropagateGlonass(*fix.glonass, stamp_ns);
}

SatelliteFix SatelliteCatalog::AtTransmission(SatelliteId satellite, SignalCode signal, TimeNs tag_ns,
                                              double pseudorange_m, bool ionosphere_free) const {
  const TimeNs by_satellite_clock = tag_ns - SecondsToNs(pseudorange_m / kSpeedOfLight);
  SatelliteFix fix = Select(satellite, signal, by_satellite_clock);
  if (fix.fault == SatelliteFault::kUnhealthy) {
    return fix;
  }
  std::optional<SatelliteState> state;
  if (fix.glonass == nullptr || fix.glonass->l2_delay_s || ionosphere_free) {
    state = InterpolatePrecise(precise_, satellite, by_satellite_clock);
  }
  fix.precise = state.has_value();
  if (!fix.precise && fix.fault != SatelliteFault::kNone) {
    return fix;
  }
  fix.fault = SatelliteFault::kNone;
  state = fix.precise ? state : Propagate(fix, by_satellite_clock);
  const TimeNs stamp_ns = by_satellite_clock - SecondsToNs(state->clock_m / kSpeedOfLight);
  fix.state = fix.precise ? InterpolatePrecise(precise_, satellite, stamp_ns).value_or(*state)
                          : Propagate(fix, stamp_ns);
  fix.accuracy_m = fix.precise ? kPreciseAccuracyM : fix.accuracy_m;
  return fix;
}

GroupDelay GroupDelayOf(const SatelliteFix& fix, SatelliteId satellite, SignalCode signal) {
  if (satellite.system == GnssSystem::kGlonass) {
    return GlonassDelay(fix.glonass, fix.precise, signal.band);
  }
  if (fix.kepler == nullptr) {
    return {0, 2};  // precise clock without a broadcast message
  }
  switch (satellite.system) {
    case GnssSystem::kGalileo:
      return GalileoDelay(*fix.kepler, fix.precise, signal.band);
    case GnssSystem::kBeidou:
      return BeidouDelay(*fix.kepler, fix.precise, signal.band);
    default:
      return GpsDelay(*fix.kepler, signal.band);
  }
}

}  // namespace alidade
