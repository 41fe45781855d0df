#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "gnss/base/constants.h"
#include "gnss/model/atmosphere.h"
#include "gnss/model/satellite_measurement.h"
#include "gnss/orbits/broadcast_orbit.h"

namespace alidade::test {

/// A constellation of made-up ephemerides around `stamp_ns`: 24 of GPS and 18 of Galileo, with clocks, health
/// 0.
inline NavigationData SyntheticSky(TimeNs stamp_ns) {
  NavigationData data;
  const auto add = [&](GnssSystem system, int number, double sqrt_a, double inclination, double node,
                       double phase) {
    KeplerEphemeris e;
    e.satellite = {system, number};
    e.message = system == GnssSystem::kGalileo ? NavMessage::kInav : NavMessage::kLnav;
    e.toe_ns = e.toc_ns = e.transmission_ns = stamp_ns - 600 * kSecondNs;
    e.toe_of_week_s = SecondsBetween(0, WeekFromGpsTime(e.toe_ns).of_week_ns);
    e.sqrt_a = sqrt_a;
    e.eccentricity = 0.002 * (number % 7);
    e.i0 = inclination;
    e.omega0 = node;
    e.m0 = phase;
    e.omega = 0.3 * number;
    e.omega_dot = -8e-9;
    e.crs = 20.0 * (number % 5) - 40;
    e.cuc = 1e-6 * (number % 3);
    e.af0 = 1e-5 * (number - 10);
    e.af1 = 1e-12 * (number - 9);
    e.group_delay_s = {1e-9 * (number - 12), system == GnssSystem::kGalileo ? 0.8e-9 * (number - 11) : 0};
    data.kepler[e.satellite].push_back(e);
  };
  for (int k = 0; k < 24; ++k) {
    const int in_plane = k / 6;
    add(GnssSystem::kGps, k + 1, 5153.7, 0.96, M_PI / 3 * (k % 6), 2 * M_PI / 4 * in_plane + 0.3 * (k % 6));
  }
  for (int k = 0; k < 18; ++k) {
    const int in_plane = k / 3;
    add(GnssSystem::kGalileo, k + 1, 5440.6, 0.98, 2 * M_PI / 3 * (k % 3),
        2 * M_PI / 6 * in_plane + 0.2 * (k % 3));
  }
  return data;
}

/// A receiver that moves evenly.
struct SyntheticReceiver {
  Eigen::Vector3d position_E = Eigen::Vector3d(3582105, 532590, 5232755);  ///< at `stamp_ns`
  Eigen::Vector3d velocity_E = Eigen::Vector3d::Zero();
  TimeNs stamp_ns = 0;  ///< true time
  double clock_m = 0;   ///< at the same time
  double drift_mps = 0;
  double galileo_bias_m = 0;
};

/// Flight from satellite to receiver, worked out in axes that stand still at reception.
struct Flight {
  double geometric_m = 0;
  double satellite_clock_m = 0;
};

/// `dt_s` after the receiver's stamp. The time of transmission is found by iteration, without the series in
/// omega / c that the models use.
inline Flight FlightAt(const KeplerEphemeris& e, const SyntheticReceiver& receiver, double dt_s) {
  const Eigen::Vector3d p = receiver.position_E + dt_s * receiver.velocity_E;
  double tau = 0.075;
  Flight flight;
  for (int i = 0; i < 8; ++i) {
    // Whole nanoseconds, the rest by the satellite's rates.
    const double offset = (dt_s - tau) * 1e9;
    const auto whole = static_cast<TimeNs>(std::floor(offset));
    const double rest = (offset - static_cast<double>(whole)) * 1e-9;
    const SatelliteState s = PropagateKepler(e, receiver.stamp_ns + whole);
    const Eigen::Vector3d at = s.position_E + rest * s.velocity_E;
    const Eigen::Vector3d turned =
        Eigen::AngleAxisd(-kEarthRotationRate * tau, Eigen::Vector3d::UnitZ()) * at;
    flight.geometric_m = (turned - p).norm();
    flight.satellite_clock_m = s.clock_m + rest * s.drift_mps;
    tau = flight.geometric_m / kSpeedOfLight;
  }
  return flight;
}

/// Noise-free L1 pseudorange and Doppler of every satellite above 5 deg, with troposphere and group delay and
/// without ionosphere.
inline ObservationEpoch Observe(const NavigationData& sky, const SyntheticReceiver& receiver) {
  constexpr double kWavelength = kSpeedOfLight / 1575.42e6;
  ObservationEpoch epoch;
  epoch.stamp_ns = receiver.stamp_ns + SecondsToNs(receiver.clock_m / kSpeedOfLight);
  // What the tag in whole nanoseconds lacks.
  const double tag_error_m =
      receiver.clock_m - SecondsBetween(receiver.stamp_ns, epoch.stamp_ns) * kSpeedOfLight;
  const EnuFrame frame = EnuFrame::At(receiver.position_E);
  for (const auto& [id, ephemerides] : sky.kepler) {
    const KeplerEphemeris& e = ephemerides[0];
    const SatelliteState rough = PropagateKepler(e, receiver.stamp_ns);
    const Direction direction = DirectionTo(frame, rough.position_E);
    if (direction.elevation_rad < 5 * M_PI / 180) {
      continue;
    }
    const auto range = [&](double dt_s) {
      const Flight flight = FlightAt(e, receiver, dt_s);
      return flight.geometric_m - flight.satellite_clock_m;
    };
    const bool galileo = id.system == GnssSystem::kGalileo;
    const double delay_m = kSpeedOfLight * e.group_delay_s[galileo ? 1 : 0];
    SignalObservation signal;
    signal.signal = {'1', 'C'};
    signal.pseudorange_m =
        range(0) + receiver.clock_m - tag_error_m + delay_m + (galileo ? receiver.galileo_bias_m : 0) +
        TroposphereDelay(ToGeodetic(receiver.position_E), direction.elevation_rad, epoch.stamp_ns);
    constexpr double kHalf = 0.25;
    signal.doppler_hz = -((range(kHalf) - range(-kHalf)) / (2 * kHalf) + receiver.drift_mps) / kWavelength;
    signal.cn0_dbhz = 45;
    epoch.satellites.push_back({id, {signal}});
  }
  return epoch;
}

}  // namespace alidade::test
