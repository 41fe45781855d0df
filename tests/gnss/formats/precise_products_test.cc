#include "gnss/formats/precise_products.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "gnss/base/constants.h"
#include "gnss/formats/rinex_navigation.h"
#include "gnss/orbits/precise_orbit.h"
#include "gnss/orbits/satellite_catalog.h"
#include "tests/gnss/formats/rinex_text.h"
#include "tests/support/shared_data.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

using test::HeaderLine;
using testing::HasSubstr;

const std::string kSp3Head =
    "#dP2020  6 25  0  0  0.00000000     289 d+D   IGb14 FIT AIUB\n"
    "## 2111 345600.00000000   900.00000000 59025 0.0000000000000\n"
    "+    1   G01  0  0\n"
    "%c M  cc GPS ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc\n"
    "%c cc cc ccc ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc\n"
    "/* a remark\n";

TEST(Sp3Test, ReadsPositionsAndClocksAndLeavesBadOnesOut) {
  const std::string text = kSp3Head +
                           "*  2020  6 25  0  0  0.00000000\n"
                           "PG01  13287.682546 -15491.926575  16545.690647    703.963460\n"
                           "VG01  1.0 1.0 1.0 1.0\n"
                           "PG02      0.000000      0.000000      0.000000 999999.999999\n"
                           "*  2020  6 25  0 15  0.00000000\n"
                           "PG01  13287.682546 -15491.926575  16545.690647 999999.999999\n"
                           "PX01  13287.682546 -15491.926575  16545.690647    703.963460\n"
                           "PG03  13287.68x546 -15491.926575  16545.690647    703.963460\n"
                           "EOF\nPG01  13287.682546 -15491.926575  16545.690647    703.963460\n";
  const Result<PreciseProducts> products = ParseSp3("file", text);
  ASSERT_TRUE(products.ok()) << products.message();
  ASSERT_EQ(products->orbits.size(), 1u) << "the header's 289 epochs are not used";
  const SatelliteId g01{GnssSystem::kGps, 1};
  ASSERT_EQ(products->orbits.at(g01).size(), 2u);
  EXPECT_EQ(products->orbits.at(g01)[0].stamp_ns,
            GpsTimeFromWeek(TimeScale::kGps, 2111, 345'600 * kSecondNs));
  EXPECT_NEAR(products->orbits.at(g01)[0].position_m.y(), -15491926.575, 1e-6);
  ASSERT_EQ(products->coarse_clocks.at(g01).size(), 1u);
  EXPECT_NEAR(products->coarse_clocks.at(g01)[0].bias_s, 703.963460e-6, 1e-15);
  EXPECT_EQ(products->warnings.count, 2);
}

TEST(Sp3Test, TimeSystemIsObeyedAndFaultsAreNamed) {
  std::string utc = kSp3Head;
  utc.replace(utc.find("GPS"), 3, "UTC");
  const std::string epoch =
      "*  2020  6 25  0  0  0.00000000\nPG01  13287.682546 -15491.926575  16545.690647\n";
  EXPECT_EQ(ParseSp3("f", utc + epoch)->orbits.begin()->second[0].stamp_ns,
            GpsTimeFromWeek(TimeScale::kGps, 2111, 345'618 * kSecondNs));
  std::string unknown = kSp3Head;
  unknown.replace(unknown.find("GPS"), 3, "XYZ");
  EXPECT_THAT(ParseSp3("f", unknown + epoch).message(), HasSubstr("f:4: time system: found 'XYZ'"));
  EXPECT_THAT(ParseSp3("f", "hello\n").message(), HasSubstr("f:1: found 'hello', expected SP3"));
  EXPECT_THAT(ParseSp3("f", kSp3Head).message(), HasSubstr("holds no satellite position"));
}

TEST(RinexClockTest, BothLayoutsAreRead) {
  const std::string old_head =
      HeaderLine("     3.00           CLOCK DATA          M", "RINEX VERSION / TYPE") +
      HeaderLine("   GPS", "TIME SYSTEM ID") + HeaderLine("", "END OF HEADER");
  std::string wide(65, ' ');
  wide.replace(0, 23, "3.04                 C ");
  const std::string new_head = wide + "RINEX VERSION / TYPE\n" + std::string("   GPS") +
                               std::string(59, ' ') + "TIME SYSTEM ID\n" + std::string(65, ' ') +
                               "END OF HEADER\n";
  const std::string old_rows =
      "AR BRUX 2020 06 25 00 00 00.000000  1   -1.000000000000E-07\n"
      "AS G01  2020 06 25 00 00 00.000000  2   -1.234567890123E-05    1.0E-11\n"
      "AS G01  2020 06 25 00 00 30.000000  1   -1.234567890124E-05\n"
      "AS G02  2020 06 25 00 00 30.000000  1   -1.2345678901x4E-05\n";
  const std::string new_rows =
      "AS G01       2020 06 25 00 00 00.000000  2   -1.234567890123E-05    1.0E-11\n"
      "AS G01       2020 06 25 00 00 30.000000  1   -1.234567890124E-05\n";
  for (const std::string& text : {old_head + old_rows, new_head + new_rows}) {
    const Result<PreciseProducts> products = ParseRinexClock("file", text);
    ASSERT_TRUE(products.ok()) << products.message();
    ASSERT_EQ(products->clocks.size(), 1u);
    const auto& nodes = products->clocks.begin()->second;
    ASSERT_EQ(nodes.size(), 2u);
    EXPECT_NEAR(nodes[0].bias_s, -1.234567890123e-5, 1e-18);
    EXPECT_EQ(nodes[1].stamp_ns - nodes[0].stamp_ns, 30 * kSecondNs);
  }
  EXPECT_EQ(ParseRinexClock("f", old_head + old_rows)->warnings.count, 1);
  EXPECT_THAT(ParseRinexClock("f", old_head).message(), HasSubstr("holds no satellite clock"));
  EXPECT_THAT(ParseRinexClock("f", "x\n").message(),
              HasSubstr("f:1: found 'x', expected a RINEX clock file"));
}

/// A circular orbit of 26 560 km, inclined, seen in the turning axes; position and velocity.
SatelliteState Circle(double t) {
  constexpr double kRadius = 26'560e3;
  const double n = std::sqrt(3.986004418e14 / (kRadius * kRadius * kRadius));
  const Eigen::Vector3d u = Eigen::Vector3d(1, 0.2, 0).normalized();
  const Eigen::Vector3d w = Eigen::Vector3d(-0.1, 0.5, 0.8).cross(u).normalized();
  const Eigen::AngleAxisd turn(-kEarthRotationRate * t, Eigen::Vector3d::UnitZ());
  SatelliteState state;
  state.position_E = turn * Eigen::Vector3d(kRadius * (std::cos(n * t) * u + std::sin(n * t) * w));
  state.velocity_E = turn * Eigen::Vector3d(kRadius * n * (-std::sin(n * t) * u + std::cos(n * t) * w)) -
                     Eigen::Vector3d(0, 0, kEarthRotationRate).cross(state.position_E);
  return state;
}

PreciseProducts CircleProducts(int nodes, int step_s) {
  PreciseProducts products;
  const SatelliteId id{GnssSystem::kGps, 1};
  for (int i = 0; i < nodes; ++i) {
    products.orbits[id].push_back({i * step_s * kSecondNs, Circle(i * step_s).position_E});
    products.clocks[id].push_back({i * 300 * kSecondNs, 1e-4 + 1e-11 * 300 * i});
  }
  return products;
}

TEST(PreciseOrbitTest, InterpolatesToMillimetresEvenAtTheEnds) {
  const PreciseProducts products = CircleProducts(20, 900);
  const SatelliteId id{GnssSystem::kGps, 1};
  for (const double t : test::Steps(1, 19 * 300 - 1, 37.5)) {
    const std::optional<SatelliteState> state = InterpolatePrecise(products, id, SecondsToNs(t));
    ASSERT_TRUE(state.has_value()) << t;
    EXPECT_LT((state->position_E - Circle(t).position_E).norm(), 2e-3) << t;
    EXPECT_LT((state->velocity_E - Circle(t).velocity_E).norm(), 2e-5) << t;
    // A circle has no relativistic periodic term.
    EXPECT_NEAR(state->clock_m, kSpeedOfLight * (1e-4 + 1e-11 * t), 1e-3) << t;
    EXPECT_NEAR(state->drift_mps, kSpeedOfLight * 1e-11, 1e-6) << t;
  }
}

TEST(PreciseOrbitTest, GivesNothingAcrossGapsAndOutside) {
  PreciseProducts products = CircleProducts(30, 300);
  const SatelliteId id{GnssSystem::kGps, 1};
  EXPECT_FALSE(InterpolatePrecise(products, id, -1).has_value());
  EXPECT_FALSE(InterpolatePrecise(products, id, 29 * 300 * kSecondNs + 1).has_value());
  EXPECT_FALSE(InterpolatePrecise(products, {GnssSystem::kGps, 2}, 1000 * kSecondNs).has_value());
  EXPECT_TRUE(InterpolatePrecise(products, id, 4000 * kSecondNs).has_value());
  products.orbits[id].erase(products.orbits[id].begin() + 14, products.orbits[id].begin() + 16);
  EXPECT_FALSE(InterpolatePrecise(products, id, 4000 * kSecondNs).has_value());
  products = CircleProducts(30, 300);
  products.clocks[id].erase(products.clocks[id].begin() + 10, products.clocks[id].begin() + 20);
  EXPECT_FALSE(InterpolatePrecise(products, id, 4500 * kSecondNs).has_value());
  products.clocks.clear();
  EXPECT_FALSE(InterpolatePrecise(products, id, 1000 * kSecondNs).has_value());
}

TEST(PreciseOrbitTest, BothClockLayoutsOfOneCentreAgreeAndBroadcastIsNear) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = test::SharedDir() + "/data/gnss/precise_cod/";
  Result<PreciseProducts> orbits = ReadSp3(folder + "COD0MGXFIN_20211180000_01D_05M_ORB.SP3");
  Result<PreciseProducts> wide = ReadRinexClock(folder + "COD0MGXFIN_20211180000_01D_30S_CLK.CLK");
  Result<PreciseProducts> narrow = ReadRinexClock(folder + "COD21118_300.CLK");
  Result<NavigationData> navigation = ReadRinexNavigation(folder + "brdc1180.21n");
  ASSERT_TRUE(orbits.ok() && wide.ok() && narrow.ok() && navigation.ok());
  EXPECT_EQ(orbits->orbits.size(), 116u);
  EXPECT_EQ(orbits->orbits.at({GnssSystem::kGps, 1}).size(), 73u);
  EXPECT_EQ(orbits->warnings.count + wide->warnings.count + narrow->warnings.count, 0);
  PreciseProducts products = *orbits;
  products.Merge(*wide);
  PreciseProducts others = *orbits;
  others.Merge(*narrow);
  const TimeNs start = *GpsTimeFromCalendar(TimeScale::kGps, {2021, 4, 28, 19, 31});
  const SatelliteCatalog broadcast(*navigation);
  const SatelliteCatalog precise(*navigation, products);
  int compared = 0;
  for (const auto& [id, nodes] : products.orbits) {
    const std::optional<SatelliteState> a = InterpolatePrecise(products, id, start);
    const std::optional<SatelliteState> b = InterpolatePrecise(others, id, start);
    ASSERT_EQ(a.has_value(), b.has_value()) << ToString(id);
    if (!a) {
      continue;
    }
    EXPECT_NEAR(a->clock_m, b->clock_m, 1e-4) << ToString(id);
    const SatelliteFix near = broadcast.AtTransmission(id, {'1', 'C'}, start, 2.2e7);
    const SatelliteFix exact = precise.AtTransmission(id, {'1', 'C'}, start, 2.2e7);
    if (near.fault != SatelliteFault::kNone || !exact.precise) {
      continue;
    }
    ++compared;
    EXPECT_LT((near.state.position_E - exact.state.position_E).norm(), 6) << ToString(id);
    EXPECT_LT((near.state.velocity_E - exact.state.velocity_E).norm(), 2e-3) << ToString(id);
    EXPECT_LT(std::abs(near.state.clock_m - exact.state.clock_m), 3) << ToString(id);
    EXPECT_LT(std::abs(near.state.drift_mps - exact.state.drift_mps), 5e-3) << ToString(id);
  }
  EXPECT_GE(compared, 30);
}

}  // namespace
}  // namespace alidade
