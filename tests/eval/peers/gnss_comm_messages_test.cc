#include "eval/peers/gnss_comm_messages.h"

#include <gtest/gtest.h>

#include "eval/rosbag/gnss_messages.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "eval/rosbag/gnss_receiver_messages.h"

namespace alidade {
namespace {

const TimeNs kStamp = GpsTimeFromWeek(TimeScale::kGps, 2288, 252'801 * kSecondNs);

TEST(GnssCommMessages, AnEpochHasItsFields) {
  ObservationEpoch epoch;
  epoch.stamp_ns = kStamp;
  SignalObservation l1{{'1', 'C'}, 2.2e7, 1e8, -12.5, 45.0, 1, 0.25, 0.125};
  epoch.satellites = {{{GnssSystem::kGps, 2}, {l1}}, {{GnssSystem::kGalileo, 1}, {l1, l1}}};
  const std::string bytes = EncodeMeasurements(epoch, {});
  const auto message = ReadMeasMsg(bytes);
  ASSERT_TRUE(message.ok()) << message.message();
  ASSERT_EQ((*message)->meas.size(), 2u);
  const gnss_comm::GnssObsMsg& first = (*message)->meas[0];
  EXPECT_EQ(first.time.week, 2288u);
  EXPECT_EQ(first.time.tow, 252'801);
  EXPECT_EQ(first.sat, 2u);
  EXPECT_EQ(first.freqs.at(0), 1575.42e6);
  EXPECT_EQ(first.CN0.at(0), 45);
  EXPECT_EQ(first.LLI.at(0), 1);
  EXPECT_EQ(first.code.at(0), 1);
  EXPECT_EQ(first.psr.at(0), 2.2e7);
  EXPECT_NEAR(first.psr_std.at(0), 0.25, 1e-12);
  EXPECT_EQ(first.cp.at(0), 1e8);
  EXPECT_EQ(first.dopp.at(0), -12.5);
  EXPECT_NEAR(first.dopp_std.at(0), 0.125, 1e-12);
  EXPECT_EQ(first.status.at(0), 3);
  EXPECT_EQ((*message)->meas[1].sat, 60u);
  EXPECT_EQ((*message)->meas[1].psr.size(), 2u);
  for (size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_EQ(ReadMeasMsg(std::string_view(bytes).substr(0, length)).code(), StatusCode::kInput) << length;
  }
}

TEST(GnssCommMessages, EphemeridesHaveTheirFields) {
  KeplerEphemeris e;
  e.satellite = {GnssSystem::kGps, 9};
  e.toe_ns = kStamp;
  e.toc_ns = kStamp + kSecondNs;
  e.transmission_ns = kStamp - kSecondNs;
  e.issue = 70;
  e.sqrt_a = 5000;
  e.eccentricity = 0.01;
  e.cis = -2e-8;
  e.af2 = 1e-19;
  e.accuracy_m = 2.8;
  e.group_delay_s = {-6e-9, 3e-9};
  const std::string bytes = *EncodeEphemeris(e);
  const auto read = ReadEphemMsg(bytes);
  ASSERT_TRUE(read.ok()) << read.message();
  const gnss_comm::GnssEphemMsg& m = **read;
  EXPECT_EQ(m.sat, 9u);
  EXPECT_EQ(m.ttr.tow, 252'800);
  EXPECT_EQ(m.toe.tow, 252'801);
  EXPECT_EQ(m.toc.tow, 252'802);
  EXPECT_EQ(m.toe_tow, 252'801);
  EXPECT_EQ(m.iode, 70u);
  EXPECT_EQ(m.ura, 2.8);
  EXPECT_EQ(m.A, 25e6);
  EXPECT_EQ(m.e, 0.01);
  EXPECT_EQ(m.cis, -2e-8);
  EXPECT_EQ(m.af2, 1e-19);
  EXPECT_EQ(m.tgd0, -6e-9);
  EXPECT_EQ(m.tgd1, 3e-9);
  EXPECT_FALSE(ReadEphemMsg(std::string_view(bytes).substr(1)).ok());

  GlonassEphemeris g;
  g.satellite.number = 7;
  g.toe_ns = kStamp;
  g.channel = -4;
  g.position_m = {1, 2, 3};
  g.acceleration_mps2 = {7, 8, 9};
  g.clock_bias_s = 1e-5;
  const auto glonass = ReadGloEphemMsg(*EncodeEphemeris(g));
  ASSERT_TRUE(glonass.ok()) << glonass.message();
  EXPECT_EQ((*glonass)->sat, 39u);
  EXPECT_EQ((*glonass)->freqo, -4);
  EXPECT_EQ((*glonass)->ura, 4);
  EXPECT_EQ((*glonass)->pos_z, 3);
  EXPECT_EQ((*glonass)->acc_x, 7);
  EXPECT_EQ((*glonass)->tau_n, -1e-5);
}

TEST(GnssCommMessages, TheIonosphereHasEightNumbers) {
  const auto message = ReadFloat64ArrayMsg(EncodeIonosphere(5 * kSecondNs, {{1, 2, 3, 4}, {5, 6, 7, 8}}));
  ASSERT_TRUE(message.ok()) << message.message();
  EXPECT_EQ((*message)->header.stamp.toSec(), 5);
  EXPECT_EQ((*message)->data, (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}));
}

}  // namespace
}  // namespace alidade
