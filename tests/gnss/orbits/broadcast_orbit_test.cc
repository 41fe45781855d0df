#include "gnss/orbits/broadcast_orbit.h"

#include <gtest/gtest.h>

#include "gnss/base/geodesy.h"
#include "gnss/formats/rinex_navigation.h"
#include "gnss/orbits/satellite_catalog.h"
#include "tests/gnss/model/synthetic_sky.h"
#include "tests/support/shared_data.h"

namespace alidade {
namespace {

constexpr TimeNs kStamp = 1'593'043'200 * kSecondNs;

NavigationData Shared(const std::vector<const char*>& files) {
  NavigationData data;
  for (const char* file : files) {
    Result<NavigationData> more = ReadRinexNavigation(test::SharedDir() + "/data/gnss/" + file);
    EXPECT_TRUE(more.ok()) << more.message();
    data.Merge(more.ok() ? *more : NavigationData());
  }
  return data;
}

/// Velocity and drift against central differences of position and clock.
template <typename Propagate>
void ExpectRatesFit(const Propagate& propagate, TimeNs stamp, double tolerance, const std::string& name) {
  const SatelliteState before = propagate(stamp - kSecondNs / 2);
  const SatelliteState after = propagate(stamp + kSecondNs / 2);
  const SatelliteState now = propagate(stamp);
  EXPECT_LT((after.position_E - before.position_E - now.velocity_E).norm(), tolerance) << name;
  EXPECT_NEAR(after.clock_m - before.clock_m, now.drift_mps, 1e-6) << name;
}

TEST(BroadcastOrbitTest, KeplerRatesAreTheDerivativesOfPositionAndClock) {
  for (const auto& [id, list] : test::SyntheticSky(kStamp).kepler) {
    const KeplerEphemeris& e = list[0];
    ExpectRatesFit([&](TimeNs t) { return PropagateKepler(e, t); }, kStamp, 2e-5, ToString(id));
    KeplerEphemeris geo = e;
    geo.satellite = {GnssSystem::kBeidou, 3};
    geo.message = NavMessage::kD2;
    geo.sqrt_a = 6493.4;
    ExpectRatesFit([&](TimeNs t) { return PropagateKepler(geo, t); }, kStamp, 2e-5, "GEO");
  }
}

TEST(BroadcastOrbitTest, KeplerEnergyIsKept) {
  // Without corrections the orbit is an ellipse: v^2 / 2 - mu / r = -mu / (2 a) in axes that stand still.
  KeplerEphemeris e;
  e.sqrt_a = 5153.7;
  e.eccentricity = 0.1;
  e.i0 = 0.9;
  for (TimeNs t = -7200; t <= 7200; t += 600) {
    const SatelliteState s = PropagateKepler(e, t * kSecondNs);
    const Eigen::Vector3d v = s.velocity_E + Eigen::Vector3d(0, 0, kEarthRotationRate).cross(s.position_E);
    const double energy = 0.5 * v.squaredNorm() - 3.986005e14 / s.position_E.norm();
    EXPECT_NEAR(energy * -2 * e.sqrt_a * e.sqrt_a / 3.986005e14, 1, 1e-11);
  }
}

TEST(BroadcastOrbitTest, RelativityIsThatOfTheEccentricOrbit) {
  KeplerEphemeris e;
  e.sqrt_a = 5153.7;
  e.eccentricity = 0.02;
  for (TimeNs t = 0; t < 40'000; t += 3000) {
    const SatelliteState s = PropagateKepler(e, t * kSecondNs);
    const Eigen::Vector3d v = s.velocity_E + Eigen::Vector3d(0, 0, kEarthRotationRate).cross(s.position_E);
    EXPECT_NEAR(s.clock_m, -2 * s.position_E.dot(v) / kSpeedOfLight, 1e-6);
  }
}

/// Successive ephemerides are fitted independently: halfway between them they must agree to their accuracy.
TEST(BroadcastOrbitTest, SuccessiveMessagesAgreeInAllSystems) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const NavigationData data = Shared({"static_esbc/ESBC00DNK_R_20201770000_01D_MN.rnx",
                                      "urban_static_tst2/hksc155c.20b", "urban_static_tst2/hksc155d.20b"});
  std::map<std::string, std::pair<int, int>> good;  // by system or orbit: agreeing pairs, all pairs
  for (const auto& [id, list] : data.kepler) {
    for (std::size_t i = 0; i + 1 < list.size(); ++i) {
      const KeplerEphemeris& a = list[i];
      const KeplerEphemeris& b = list[i + 1];
      const TimeNs apart = b.toe_ns - a.toe_ns;
      if (apart <= 0 || apart > 7200 * kSecondNs || a.health != 0 || b.health != 0 ||
          a.message != b.message) {
        continue;
      }
      const TimeNs middle = a.toe_ns + apart / 2;
      const SatelliteState from_a = PropagateKepler(a, middle);
      const SatelliteState from_b = PropagateKepler(b, middle);
      auto& [agree, all] =
          good[std::string(1, Letter(id.system)) + (a.message == NavMessage::kD2 ? " GEO" : "")];
      agree += (from_a.position_E - from_b.position_E).norm() < 6 &&
                       std::abs(from_a.clock_m - from_b.clock_m) < 3 &&
                       (from_a.velocity_E - from_b.velocity_E).norm() < 3e-3
                   ? 1
                   : 0;
      ++all;
    }
  }
  for (const auto& [number, list] : data.glonass) {
    for (std::size_t i = 0; i + 1 < list.size(); ++i) {
      if (list[i + 1].toe_ns - list[i].toe_ns != 1800 * kSecondNs) {
        continue;
      }
      const SatelliteState from_a = PropagateGlonass(list[i], list[i].toe_ns + 900 * kSecondNs);
      const SatelliteState from_b = PropagateGlonass(list[i + 1], list[i].toe_ns + 900 * kSecondNs);
      auto& [agree, all] = good["R"];
      agree += (from_a.position_E - from_b.position_E).norm() < 6 &&
                       (from_a.velocity_E - from_b.velocity_E).norm() < 5e-3
                   ? 1
                   : 0;
      ++all;
    }
  }
  ASSERT_EQ(good.size(), 6u) << "G E C, GEO of C, J, R";
  for (const auto& [name, counts] : good) {
    EXPECT_GE(counts.second, 5) << name;
    EXPECT_GE(counts.first, 0.95 * counts.second) << name << ": " << counts.first << " of " << counts.second;
  }
}

TEST(BroadcastOrbitTest, BeidouGeoStandsOverTheEquatorAtItsPublishedLongitude) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const NavigationData data = Shared({"urban_static_tst2/hksc155c.20b"});
  // Slots of the BeiDou-2 GEOs; C01 and C02 have been moved by 4 deg to the east since they were published.
  for (const auto& [number, longitude, moved] :
       {std::tuple{1, 140.0, 4.2}, std::tuple{2, 80.0, 4.2}, std::tuple{3, 110.5, 0.0},
        std::tuple{4, 160.0, 0.0}, std::tuple{5, 58.75, 0.0}}) {
    const auto found = data.kepler.find({GnssSystem::kBeidou, number});
    ASSERT_NE(found, data.kepler.end()) << number;
    const KeplerEphemeris& e = found->second[0];
    ASSERT_EQ(e.message, NavMessage::kD2);
    for (const TimeNs hours : {-2, 0, 2}) {
      const SatelliteState state = PropagateKepler(e, e.toe_ns + hours * 3600 * kSecondNs);
      const GeodeticPosition place = ToGeodetic(state.position_E);
      EXPECT_NEAR(place.longitude_rad * 180 / M_PI, longitude + moved, 0.5) << number;
      EXPECT_LT(std::abs(place.latitude_rad * 180 / M_PI), 3) << number;
      EXPECT_LT(state.velocity_E.norm(), 150) << number;
    }
  }
}

TEST(BroadcastOrbitTest, GlonassVelocityIsTheDerivativeOfPosition) {
  GlonassEphemeris e;
  e.toe_ns = kStamp;
  e.position_m = {8498656.25, 19647589.84375, -13877683.98};
  e.velocity_mps = {-1179.23, -1494.42, -2834.57};
  e.acceleration_mps2 = {-1.86e-6, 0, 1.86e-6};
  e.clock_drift = 1e-12;
  for (const TimeNs offset : {-1800, -61, -60, 0, 30, 899}) {
    ExpectRatesFit([&](TimeNs t) { return PropagateGlonass(e, t); }, kStamp + offset * kSecondNs, 2e-4,
                   "GLONASS");
  }
}

TEST(SatelliteCatalogTest, ChoosesByAgeAndHealth) {
  const TimeNs hour = 3600 * kSecondNs;
  NavigationData sky = test::SyntheticSky(kStamp);
  const SatelliteId id{GnssSystem::kGps, 5};
  KeplerEphemeris later = sky.kepler[id][0];
  const TimeNs first_toe = later.toe_ns;
  later.toe_ns += 2 * hour;
  later.toc_ns += 2 * hour;
  later.issue = 77;
  sky.kepler[id].push_back(later);
  const auto fix = [&](TimeNs stamp) {
    return SatelliteCatalog(sky).AtTransmission(id, {'1', 'C'}, stamp, 2.2e7);
  };
  const SatelliteCatalog catalog(sky);
  EXPECT_EQ(catalog.AtTransmission(id, {'1', 'C'}, first_toe + hour / 2, 2.2e7).kepler->issue, 0);
  EXPECT_EQ(catalog.AtTransmission(id, {'1', 'C'}, first_toe + 2 * hour, 2.2e7).kepler->issue, 77);
  EXPECT_EQ(fix(first_toe - 2 * hour - kSecondNs).fault, SatelliteFault::kNoEphemeris);
  EXPECT_EQ(fix(first_toe + 4 * hour + 2 * kSecondNs).fault, SatelliteFault::kNoEphemeris);
  EXPECT_EQ(catalog.AtTransmission({GnssSystem::kGps, 99}, {'1', 'C'}, kStamp, 2.2e7).fault,
            SatelliteFault::kNoEphemeris);
  sky.kepler[id][1].health = 1;
  EXPECT_EQ(fix(first_toe + 2 * hour).fault, SatelliteFault::kUnhealthy);
  EXPECT_EQ(fix(first_toe).fault, SatelliteFault::kNone);
}

TEST(SatelliteCatalogTest, GalileoHealthIsThatOfTheSignal) {
  NavigationData sky = test::SyntheticSky(kStamp);
  const SatelliteId id{GnssSystem::kGalileo, 4};
  const auto fault = [&](int health, char band) {
    sky.kepler[id][0].health = health;
    return SatelliteCatalog(sky).AtTransmission(id, {band, 'Q'}, kStamp, 2.2e7).fault;
  };
  // 130 = E1-B and E5b out of service (RINEX 3.05 table A8).
  EXPECT_EQ(fault(130, '1'), SatelliteFault::kUnhealthy);
  EXPECT_EQ(fault(130, '7'), SatelliteFault::kUnhealthy);
  EXPECT_EQ(fault(130, '5'), SatelliteFault::kNone);
  EXPECT_EQ(fault(8, '5'), SatelliteFault::kUnhealthy);
  EXPECT_EQ(fault(8, '1'), SatelliteFault::kNone);
}

TEST(SatelliteCatalogTest, TransmissionDoesNotDependOnTheReceiversClock) {
  const NavigationData sky = test::SyntheticSky(kStamp);
  const SatelliteCatalog catalog(sky);
  const SatelliteId id{GnssSystem::kGps, 3};
  const SatelliteFix fix = catalog.AtTransmission(id, {'1', 'C'}, kStamp, 2.2e7);
  const SatelliteFix jumped =
      catalog.AtTransmission(id, {'1', 'C'}, kStamp + 5 * kSecondNs / 1000, 2.2e7 + 5e-3 * kSpeedOfLight);
  EXPECT_LT((fix.state.position_E - jumped.state.position_E).norm(), 1e-4);
  // t = tag - P / c - dt_S
  const TimeNs stamp =
      kStamp - SecondsToNs(2.2e7 / kSpeedOfLight) - SecondsToNs(fix.state.clock_m / kSpeedOfLight);
  EXPECT_LT((fix.state.position_E - PropagateKepler(sky.kepler.at(id)[0], stamp).position_E).norm(), 1e-3);
}

}  // namespace
}  // namespace alidade
