#include "eval/simulation/sim_constellation.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/check.h"
#include "gnss/base/constants.h"
#include "gnss/formats/rinex_navigation.h"
#include "gnss/formats/rinex_writer.h"
#include "gnss/orbits/broadcast_orbit.h"

namespace alidade {
namespace {

constexpr TimeNs kHourNs = 3600 * kSecondNs;
constexpr double kNodeRate = -8e-9;  // [rad/s], about that of a GPS orbit

/// A Walker constellation: satellites evenly in planes, planes evenly around the axis.
struct Walker {
  GnssSystem system;
  int planes;
  int per_plane;
  double semi_major_axis_m;
  double inclination_rad;
  double node_rad;         ///< of the first plane
  double plane_phase_rad;  ///< from plane to plane
  int first_number;
};

constexpr double kGpsAxisM = 26559.8e3;
constexpr Walker kWalkers[] = {
    {GnssSystem::kGps, 6, 4, kGpsAxisM, 0.96, 0.2, 0.35, 1},
    {GnssSystem::kGalileo, 3, 8, 29600.3e3, 0.977, 0.5, 0.26, 1},
    {GnssSystem::kBeidou, 3, 8, 27906.1e3, 0.96, 0.9, 0.26, 19},
    {GnssSystem::kGlonass, 3, 8, 25508e3, 1.13, 1.3, 0.26, 1},
};

/// An angle in (-pi, pi].
double Wrap(double angle) {
  return std::remainder(angle, 2 * M_PI);
}

/// The message of satellite k of a constellation with this reference time.
KeplerEphemeris MakeMessage(const Walker& walker, int k, TimeNs toe_ns) {
  const double mu = walker.system == GnssSystem::kGps ? 3.986005e14 : 3.986004418e14;
  const int plane = k / walker.per_plane;
  KeplerEphemeris e;
  e.satellite = {walker.system, walker.first_number + k};
  e.message = walker.system == GnssSystem::kGalileo
                  ? NavMessage::kInav
                  : (walker.system == GnssSystem::kBeidou ? NavMessage::kD1 : NavMessage::kLnav);
  e.data_source = walker.system == GnssSystem::kGalileo ? 517 : 0;
  e.toe_ns = e.toc_ns = toe_ns;
  e.transmission_ns = toe_ns;
  const TimeScale scale = walker.system == GnssSystem::kBeidou ? TimeScale::kBeidou : TimeScale::kGps;
  const TimeNs of_week_ns = (toe_ns - GpsTimeFromWeek(scale, 0, 0)) % kWeekNs;
  e.toe_of_week_s = SecondsBetween(0, of_week_ns);
  e.sqrt_a = std::sqrt(walker.semi_major_axis_m);
  e.eccentricity = 0.0005 * (1 + (3 * k) % 7);
  e.i0 = walker.inclination_rad + 0.005 * (k % 3 - 1);
  e.omega = Wrap(0.7 * k);
  e.omega_dot = kNodeRate;
  // Node and anomaly run on from the beginning of the week.
  const double rate = std::sqrt(mu / std::pow(walker.semi_major_axis_m, 3));
  e.omega0 = Wrap(walker.node_rad + 2 * M_PI * plane / walker.planes + kNodeRate * e.toe_of_week_s);
  e.m0 = Wrap(2 * M_PI * (k % walker.per_plane) / walker.per_plane + walker.plane_phase_rad * plane -
              0.7 * k + rate * e.toe_of_week_s);
  e.crs = 15.0 * (k % 5) - 30;
  e.crc = 200 + 10.0 * (k % 4);
  e.cuc = 1e-6 * (k % 3 - 1);
  e.cus = 5e-6;
  e.af1 = 1e-12 * (k % 9 - 4);
  e.af0 = 2e-5 * (k % 11 - 5) + e.af1 * e.toe_of_week_s;
  // What healthy satellites broadcast most of the time: URA index 0 and SISA index 107.
  e.accuracy_m = walker.system == GnssSystem::kGalileo ? 3.12 : 2;
  e.issue = static_cast<int>(of_week_ns / kHourNs) % 240;
  e.group_delay_s = {1e-9 * (k % 13 - 6), walker.system == GnssSystem::kGps ? 0 : 1.2e-9 * (k % 13 - 6)};
  return e;
}

/// GLONASS sends position and velocity: those of the Kepler orbit.
GlonassEphemeris MakeGlonass(const Walker& walker, int k, TimeNs toe_ns) {
  KeplerEphemeris orbit = MakeMessage(walker, k, toe_ns);
  orbit.satellite.system = GnssSystem::kGps;  // the plain Kepler orbit
  const SatelliteState state = PropagateKepler(orbit, toe_ns);
  GlonassEphemeris e;
  e.satellite.number = walker.first_number + k;
  e.toe_ns = e.transmission_ns = toe_ns;
  e.position_m = state.position_E;
  e.velocity_mps = state.velocity_E;
  e.clock_bias_s = orbit.af0;
  e.clock_drift = orbit.af1;
  e.channel = k % 14 - 7;
  return e;
}

}  // namespace

NavigationData SimulateConstellations(const std::string& systems, TimeNs from_ns, TimeNs to_ns) {
  NavigationData data;
  data.gps_ionosphere = KlobucharParameters{{1.2e-8, 1.5e-8, -6e-8, -1.2e-7}, {9.4e4, 4.9e4, -2e5, -3.3e5}};
  data.leap_seconds = LeapSeconds(from_ns);
  for (const Walker& walker : kWalkers) {
    if (systems.find(Letter(walker.system)) == std::string::npos) {
      continue;
    }
    const bool glonass = walker.system == GnssSystem::kGlonass;
    const TimeNs spacing = glonass ? kHourNs / 2 : kHourNs;
    // Of GLONASS the reference is a label of UTC on the quarter.
    const TimeNs shift = glonass ? LeapSeconds(from_ns) * kSecondNs : 0;
    for (TimeNs toe = (from_ns / spacing) * spacing; toe <= to_ns + spacing; toe += spacing) {
      for (int k = 0; k < walker.planes * walker.per_plane; ++k) {
        if (glonass) {
          data.glonass[walker.first_number + k].push_back(MakeGlonass(walker, k, toe + shift));
        } else {
          const KeplerEphemeris e = MakeMessage(walker, k, toe);
          data.kepler[e.satellite].push_back(e);
        }
      }
    }
  }
  Result<NavigationData> rounded =
      ParseRinexNavigation("embedded constellation", FormatRinexNavigation(data));
  CHECK(rounded.ok()) << rounded.message();
  CHECK_EQ(rounded->ephemerides(), data.ephemerides());
  return *std::move(rounded);
}

}  // namespace alidade
