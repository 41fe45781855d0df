#pragma once

#include "core/time.h"
#include "gnss/formats/ephemeris.h"

namespace alidade::test {

inline const TimeNs kStamp = GpsTimeFromWeek(TimeScale::kGps, 2288, 252'801 * kSecondNs);

inline KeplerEphemeris Ephemeris(SatelliteId satellite) {
  KeplerEphemeris e;
  e.satellite = satellite;
  const bool beidou = satellite.system == GnssSystem::kBeidou;
  e.message = beidou                                     ? NavMessage::kD1
              : satellite.system == GnssSystem::kGalileo ? NavMessage::kInav
                                                         : NavMessage::kLnav;
  e.toc_ns = e.toe_ns = GpsTimeFromWeek(beidou ? TimeScale::kBeidou : TimeScale::kGps, beidou ? 932 : 2288,
                                        252'000 * kSecondNs);
  e.toe_of_week_s = 252'000;
  e.transmission_ns = e.toe_ns - 30 * kSecondNs;
  e.af0 = -1.01e-4;
  e.af1 = -4e-12;
  e.issue = 70;
  e.sqrt_a = 5153.62008689;
  e.eccentricity = 5e-4;
  e.i0 = 0.955;
  e.omega0 = 0.198;
  e.omega = 1.0 / 3;
  e.m0 = -0.94;
  e.delta_n = 4e-9;
  e.omega_dot = -8e-9;
  e.i_dot = 1e-10;
  e.cuc = -1e-6;
  e.cus = 5e-6;
  e.crc = 200;
  e.crs = -30;
  e.cic = 1e-8;
  e.cis = -2e-8;
  e.accuracy_m = 2.8;
  e.data_source = satellite.system == GnssSystem::kGalileo ? 517 : 0;
  e.group_delay_s = {-6e-9, satellite.system == GnssSystem::kGps ? 0 : 3e-9};
  return e;
}

inline GlonassEphemeris Glonass() {
  GlonassEphemeris e;
  e.satellite = {GnssSystem::kGlonass, 7};
  e.toe_ns = kStamp - kStamp % (900 * kSecondNs) + 18 * kSecondNs;
  e.transmission_ns = e.toe_ns - 100 * kSecondNs;
  e.clock_bias_s = 1.0 / 7e4;
  e.clock_drift = 1e-12;
  e.position_m = {1.2345678e7, -1.0e7, 1.9e7 + 1.0 / 3};
  e.velocity_mps = {1000.1, -2000.2, 1.0 / 3};
  e.acceleration_mps2 = {1e-6, 0, -9.3132e-7};
  e.channel = -4;
  e.l2_delay_s = 2.8e-9;
  return e;
}

}  // namespace alidade::test
