#include <gtest/gtest.h>

#include "gnss/base/constants.h"
#include "gnss/orbits/satellite_catalog.h"

namespace alidade {
namespace {

constexpr double kMetre = 1 / kSpeedOfLight;

double Squared(double f1, double f2) {
  return f1 * f1 / (f2 * f2);
}

KeplerEphemeris Message(NavMessage message, double first_m, double second_m) {
  KeplerEphemeris e;
  e.message = message;
  e.group_delay_s = {first_m * kMetre, second_m * kMetre};
  return e;
}

double Delay(GnssSystem system, const KeplerEphemeris& e, char band, bool precise = false) {
  SatelliteFix fix;
  fix.kepler = &e;
  fix.precise = precise;
  return GroupDelayOf(fix, {system, 7}, {band, 'X'}).delay_m;
}

/// The pair a clock refers to has no delay against it.
double Pair(GnssSystem system, const KeplerEphemeris& e, char b1, double f1, char b2, double f2,
            bool precise) {
  const double a1 = f1 * f1 / (f1 * f1 - f2 * f2);
  return a1 * Delay(system, e, b1, precise) + (1 - a1) * Delay(system, e, b2, precise);
}

TEST(GroupDelayTest, SingleSignalsFollowTheIcds) {
  const KeplerEphemeris gps = Message(NavMessage::kLnav, 3, 0);
  EXPECT_NEAR(Delay(GnssSystem::kGps, gps, '1'), 3, 1e-12);
  EXPECT_NEAR(Delay(GnssSystem::kGps, gps, '2'), 3 * Squared(77, 60), 1e-12);
  const KeplerEphemeris fnav = Message(NavMessage::kFnav, 3, 0);
  EXPECT_NEAR(Delay(GnssSystem::kGalileo, fnav, '1'), 3, 1e-12);
  EXPECT_NEAR(Delay(GnssSystem::kGalileo, fnav, '5'), 3 * Squared(154, 115), 1e-12);
  const KeplerEphemeris inav = Message(NavMessage::kInav, 3, 5);
  EXPECT_NEAR(Delay(GnssSystem::kGalileo, inav, '1'), 5, 1e-12);
  EXPECT_NEAR(Delay(GnssSystem::kGalileo, inav, '7'), 5 * Squared(154, 118), 1e-12);
  const KeplerEphemeris d1 = Message(NavMessage::kD1, 3, 5);
  EXPECT_NEAR(Delay(GnssSystem::kBeidou, d1, '2'), 3, 1e-12);
  EXPECT_NEAR(Delay(GnssSystem::kBeidou, d1, '7'), 5, 1e-12);
  EXPECT_NEAR(Delay(GnssSystem::kBeidou, d1, '6'), 0, 1e-12);
  EXPECT_NEAR(Delay(GnssSystem::kBeidou, d1, '1'), 3, 1e-12) << "B1C is near to B1I";
}

TEST(GroupDelayTest, ThePairOfTheClockHasNone) {
  const KeplerEphemeris gps = Message(NavMessage::kLnav, 3, 0);
  EXPECT_NEAR(Pair(GnssSystem::kGps, gps, '1', 154, '2', 120, false), 0, 1e-12);
  const KeplerEphemeris inav = Message(NavMessage::kInav, 3, 5);
  EXPECT_NEAR(Pair(GnssSystem::kGalileo, inav, '1', 154, '7', 118, false), 0, 1e-12);
  EXPECT_NEAR(Pair(GnssSystem::kGalileo, inav, '1', 154, '5', 115, true), 0, 1e-12);
  const KeplerEphemeris fnav = Message(NavMessage::kFnav, 3, 0);
  EXPECT_NEAR(Pair(GnssSystem::kGalileo, fnav, '1', 154, '5', 115, false), 0, 1e-12);
  const KeplerEphemeris d1 = Message(NavMessage::kD1, 3, 5);
  EXPECT_NEAR(Pair(GnssSystem::kBeidou, d1, '2', 1561.098, '6', 1268.52, true), 0, 1e-12);
}

TEST(GroupDelayTest, InavAndFnavClocksDifferByTheBroadcastDelays) {
  // The same E1 signal against either clock: their difference is BGD(E1,E5b) - BGD(E1,E5a).
  const KeplerEphemeris inav = Message(NavMessage::kInav, 3, 5);
  const KeplerEphemeris fnav = Message(NavMessage::kFnav, 3, 0);
  const double clocks = Delay(GnssSystem::kGalileo, inav, '1') - Delay(GnssSystem::kGalileo, fnav, '1');
  EXPECT_NEAR(clocks, 2, 1e-12);
  EXPECT_NEAR(Delay(GnssSystem::kGalileo, inav, '5') - Delay(GnssSystem::kGalileo, fnav, '5'), clocks, 1e-12);
}

TEST(GroupDelayTest, WhatIsNotBroadcastWidensTheDeviation) {
  const KeplerEphemeris gps = Message(NavMessage::kLnav, 3, 0);
  SatelliteFix fix;
  fix.kepler = &gps;
  EXPECT_EQ(GroupDelayOf(fix, {GnssSystem::kGps, 1}, {'1', 'C'}).deviation_m, 0);
  EXPECT_GT(GroupDelayOf(fix, {GnssSystem::kGps, 1}, {'5', 'Q'}).deviation_m, 1);
  GlonassEphemeris glonass;
  SatelliteFix slow;
  slow.glonass = &glonass;
  EXPECT_EQ(GroupDelayOf(slow, {GnssSystem::kGlonass, 1}, {'1', 'C'}).deviation_m, 0);
  EXPECT_GT(GroupDelayOf(slow, {GnssSystem::kGlonass, 1}, {'2', 'C'}).deviation_m, 1);
  glonass.l2_delay_s = 2 * kMetre;
  EXPECT_NEAR(GroupDelayOf(slow, {GnssSystem::kGlonass, 1}, {'2', 'C'}).delay_m, 2, 1e-12);
  EXPECT_EQ(GroupDelayOf(slow, {GnssSystem::kGlonass, 1}, {'2', 'C'}).deviation_m, 0);
}

}  // namespace
}  // namespace alidade
