#include "eval/rosbag/gnss_navigation_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "eval/rosbag/ros_header.h"
#include "gnss/formats/rinex_writer.h"
#include "tests/eval/rosbag/gnss_samples.h"

namespace alidade {
namespace {

using test::Ephemeris;
using test::Glonass;
using testing::HasSubstr;

/// What RINEX prints of an ephemeris: every number it has.
std::string Text(const KeplerEphemeris& e) {
  NavigationData data;
  data.kepler[e.satellite].push_back(e);
  return FormatRinexNavigation(data);
}

TEST(GnssEphemerides, ComeBackEqual) {
  for (const SatelliteId id :
       {SatelliteId{GnssSystem::kGps, 9}, {GnssSystem::kGalileo, 36}, {GnssSystem::kBeidou, 20}}) {
    const KeplerEphemeris e = Ephemeris(id);
    const Result<KeplerEphemeris> back = DecodeKeplerEphemeris(*EncodeEphemeris(e));
    ASSERT_TRUE(back.ok()) << back.message();
    EXPECT_EQ(Text(*back), Text(e));
    EXPECT_EQ(back->sqrt_a, e.sqrt_a);
    EXPECT_EQ(back->omega, e.omega);
    EXPECT_EQ(back->message, e.message);
    EXPECT_EQ(back->toe_ns, e.toe_ns);
    EXPECT_EQ(back->toe_of_week_s, e.toe_of_week_s);
    EXPECT_EQ(back->transmission_ns, e.transmission_ns);
  }
  EXPECT_FALSE(EncodeEphemeris(Ephemeris({GnssSystem::kQzss, 1})).has_value());
  const GlonassEphemeris e = Glonass();
  const Result<GlonassEphemeris> back = DecodeGlonassEphemeris(*EncodeEphemeris(e));
  ASSERT_TRUE(back.ok()) << back.message();
  EXPECT_EQ(back->satellite, e.satellite);
  EXPECT_EQ(back->toe_ns, e.toe_ns);
  EXPECT_EQ(back->transmission_ns, e.transmission_ns);
  EXPECT_EQ(back->clock_bias_s, e.clock_bias_s);
  EXPECT_EQ(back->clock_drift, e.clock_drift);
  EXPECT_EQ(back->position_m, e.position_m);
  EXPECT_EQ(back->velocity_mps, e.velocity_mps);
  EXPECT_EQ(back->acceleration_mps2, e.acceleration_mps2);
  EXPECT_EQ(back->channel, e.channel);
  EXPECT_EQ(back->l2_delay_s, e.l2_delay_s);
}

TEST(GnssEphemerides, HoldTheAccuracyInMetres) {
  const KeplerEphemeris e = Ephemeris({GnssSystem::kGps, 9});
  const std::string kepler = *EncodeEphemeris(e);
  ByteReader in(kepler);
  // Satellite, three times, time of week, week, issues, health, code.
  static_cast<void>(in.Take(4 + 3 * 12 + 8 + 5 * 4));
  EXPECT_EQ(in.Read<double>(), 2.8);
  const std::string glonass = *EncodeEphemeris(Glonass());
  ByteReader of_glonass(glonass);
  // Satellite, two times, channel, issue, health, age.
  static_cast<void>(of_glonass.Take(4 + 2 * 12 + 4 * 4));
  EXPECT_EQ(of_glonass.Read<double>(), 4);
}

TEST(GnssEphemerides, NonsenseIsRefused) {
  KeplerEphemeris e = Ephemeris({GnssSystem::kGps, 9});
  e.sqrt_a = std::nan("");
  EXPECT_THAT(DecodeKeplerEphemeris(*EncodeEphemeris(e)).message(), HasSubstr("semi-major axis"));
  e = Ephemeris({GnssSystem::kGps, 9});
  e.eccentricity = 0.9;
  EXPECT_THAT(DecodeKeplerEphemeris(*EncodeEphemeris(e)).message(), HasSubstr("eccentricity"));
  GlonassEphemeris g = Glonass();
  g.position_m.setZero();
  EXPECT_FALSE(DecodeGlonassEphemeris(*EncodeEphemeris(g)).ok());
  EXPECT_FALSE(DecodeGlonassEphemeris(*EncodeEphemeris(Ephemeris({GnssSystem::kGps, 9}))).ok());
}

}  // namespace
}  // namespace alidade
