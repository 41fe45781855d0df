#include "eval/rosbag/gnss_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "eval/rosbag/gnss_message_time.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "gnss/formats/rinex_writer.h"

namespace alidade {
namespace {

using testing::HasSubstr;

const TimeNs kStamp = GpsTimeFromWeek(TimeScale::kGps, 2288, 252'801 * kSecondNs);

KeplerEphemeris Ephemeris(SatelliteId satellite) {
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

GlonassEphemeris Glonass() {
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

/// What RINEX prints of an ephemeris: every number it has.
std::string Text(const KeplerEphemeris& e) {
  NavigationData data;
  data.kepler[e.satellite].push_back(e);
  return FormatRinexNavigation(data);
}

TEST(GnssCommNumbers, GoBySystemAndNumber) {
  EXPECT_EQ(GnssCommNumber({GnssSystem::kGps, 1}), 1u);
  EXPECT_EQ(GnssCommNumber({GnssSystem::kGps, 32}), 32u);
  EXPECT_EQ(GnssCommNumber({GnssSystem::kGlonass, 1}), 33u);
  EXPECT_EQ(GnssCommNumber({GnssSystem::kGalileo, 1}), 60u);
  EXPECT_EQ(GnssCommNumber({GnssSystem::kBeidou, 1}), 98u);
  EXPECT_EQ(GnssCommNumber({GnssSystem::kBeidou, 63}), 160u);
  EXPECT_FALSE(GnssCommNumber({GnssSystem::kGps, 33}).has_value());
  EXPECT_FALSE(GnssCommNumber({GnssSystem::kQzss, 1}).has_value());
  EXPECT_FALSE(SatelliteOfGnssCommNumber(0).has_value());
  EXPECT_FALSE(SatelliteOfGnssCommNumber(161).has_value());
  for (std::uint32_t number = 1; number <= 160; ++number) {
    EXPECT_EQ(GnssCommNumber(*SatelliteOfGnssCommNumber(number)), number);
  }
}

TEST(GnssMeasurements, ComeBackEqual) {
  ObservationEpoch epoch;
  epoch.stamp_ns = kStamp + 100'000'000;
  SignalObservation l1{{'1', 'C'}, 22269246.835, 1.1e8 + 1.0 / 3, 970.928, 45.25, 1, {}, {}};
  SignalObservation l5{{'5', 'Q'}, 22269250.5, {}, -12.5, {}, 0, {}, {}};
  epoch.satellites = {{{GnssSystem::kGps, 2}, {l1, l5}}, {{GnssSystem::kBeidou, 20}, {l1}}};
  epoch.satellites[1].signals[0].signal = {'2', 'I'};
  epoch.satellites.push_back({{GnssSystem::kGlonass, 7}, {l1}});
  std::map<int, int> channels;
  const Result<ObservationEpoch> back = DecodeMeasurements(EncodeMeasurements(epoch, {{7, -4}}), &channels);
  ASSERT_TRUE(back.ok()) << back.message();
  EXPECT_EQ(back->stamp_ns, epoch.stamp_ns);
  EXPECT_EQ(channels, (std::map<int, int>{{7, -4}}));
  ASSERT_EQ(back->satellites.size(), 3u);
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_EQ(back->satellites[s].satellite, epoch.satellites[s].satellite);
    ASSERT_EQ(back->satellites[s].signals.size(), epoch.satellites[s].signals.size());
    for (std::size_t i = 0; i < epoch.satellites[s].signals.size(); ++i) {
      const SignalObservation& a = back->satellites[s].signals[i];
      const SignalObservation& b = epoch.satellites[s].signals[i];
      EXPECT_EQ(ToString(a.signal), ToString(b.signal));
      EXPECT_EQ(a.pseudorange_m, b.pseudorange_m);
      EXPECT_EQ(a.phase_cycles, b.phase_cycles);
      EXPECT_EQ(a.doppler_hz, b.doppler_hz);
      EXPECT_EQ(a.cn0_dbhz, b.cn0_dbhz);
      EXPECT_EQ(a.loss_of_lock, b.loss_of_lock);
    }
  }
}

/// Deviations of pseudorange and Doppler in a message of one satellite and signal.
std::pair<double, double> DeviationsIn(const SignalObservation& signal) {
  ObservationEpoch epoch;
  epoch.stamp_ns = kStamp;
  epoch.satellites = {{{GnssSystem::kGps, 2}, {signal}}};
  const std::string bytes = EncodeMeasurements(epoch, {});
  ByteReader in(bytes);
  // Count, time and satellite; then frequency, C/N0, LLI, code and pseudorange.
  static_cast<void>(in.Take(4 + 12 + 4));
  static_cast<void>(in.Array<double>());
  static_cast<void>(in.Array<double>());
  static_cast<void>(in.Array<std::uint8_t>());
  static_cast<void>(in.Array<std::uint8_t>());
  static_cast<void>(in.Array<double>());
  const double pseudorange = in.Array<double>().at(0);
  for (int i = 0; i < 3; ++i) {
    static_cast<void>(in.Array<double>());
  }
  return {pseudorange, in.Array<double>().at(0)};
}

// Readers of these messages weigh by them: GVINS aborts on zero, InGVIO never aligns.
TEST(GnssMeasurements, HoldDeviationsByStrengthOrAsReported) {
  const double wavelength = 299792458.0 / 1575.42e6;
  SignalObservation signal{{'1', 'C'}, 2.2e7, {}, 970.9, 45.0, 0, {}, {}};
  EXPECT_NEAR(DeviationsIn(signal).first, 0.7, 1e-12) << "the estimators' default at 45 dB-Hz";
  EXPECT_NEAR(DeviationsIn(signal).second, 0.05 / wavelength, 1e-12);
  signal.cn0_dbhz = 35;
  EXPECT_NEAR(DeviationsIn(signal).first, 0.7 * std::sqrt(10.0), 1e-12) << "ten times the variance";
  EXPECT_NEAR(DeviationsIn(signal).second, 0.05 / wavelength * std::sqrt(10.0), 1e-12);
  signal.cn0_dbhz.reset();
  EXPECT_NEAR(DeviationsIn(signal).first, 0.7, 1e-12);
  signal.pseudorange_std_m = 0.32;
  signal.doppler_std_hz = 0.128;
  EXPECT_NEAR(DeviationsIn(signal).first, 0.32, 1e-12);
  EXPECT_NEAR(DeviationsIn(signal).second, 0.128, 1e-12);
  signal.doppler_hz.reset();
  EXPECT_EQ(DeviationsIn(signal).second, 0) << "not measured";
}

// u-blox' driver names B1I by its old code 47; other drivers leave the code out.
TEST(GnssMeasurements, SignalsAreRecognisedByCodeOrFrequency) {
  for (const auto& [code, frequency] : {std::pair<int, double>(47, 1561.098e6), {40, 0}, {0, 1561.098e6}}) {
    ByteWriter out;
    out.Write(std::uint32_t{1});
    PutGnssTime(kStamp, &out);
    out.Write(*GnssCommNumber({GnssSystem::kBeidou, 20}));
    out.Array(std::vector<double>{frequency});
    out.Array(std::vector<double>{40});
    out.Array(std::vector<std::uint8_t>{0});
    out.Array(std::vector<std::uint8_t>{static_cast<std::uint8_t>(code)});
    out.Array(std::vector<double>{2.3e7});
    for (int i = 0; i < 5; ++i) {
      out.Array(std::vector<double>{1});
    }
    out.Array(std::vector<std::uint8_t>{1});
    std::map<int, int> channels;
    const Result<ObservationEpoch> epoch = DecodeMeasurements(out.bytes(), &channels);
    ASSERT_TRUE(epoch.ok()) << epoch.message();
    ASSERT_EQ(epoch->satellites.at(0).signals.size(), 1u) << code;
    EXPECT_EQ(epoch->satellites[0].signals[0].signal.band, '2') << code;
    EXPECT_EQ(epoch->satellites[0].signals[0].pseudorange_m, 2.3e7);
    EXPECT_FALSE(epoch->satellites[0].signals[0].phase_cycles.has_value())
        << "its status says it is not valid";
  }
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

TEST(GnssMessages, TornOrScrambledBytesAreRefusedOrHarmless) {
  ObservationEpoch epoch;
  epoch.stamp_ns = kStamp;
  epoch.satellites = {{{GnssSystem::kGps, 2}, {{{'1', 'C'}, 2.2e7, {}, 1.0, 45.0, 0, {}, {}}}}};
  std::map<int, int> channels;
  const std::string messages[] = {
      EncodeMeasurements(epoch, {}), *EncodeEphemeris(Ephemeris({GnssSystem::kGps, 9})),
      *EncodeEphemeris(Glonass()), EncodeSolution({kStamp, true, 2, 22, 114, 5, 1, 1}),
      EncodeTimePulse(kStamp)};
  const auto decode = [&](std::size_t kind, std::string_view bytes) {
    switch (kind) {
      case 0:
        return DecodeMeasurements(bytes, &channels).ok();
      case 1:
        return DecodeKeplerEphemeris(bytes).ok();
      case 2:
        return DecodeGlonassEphemeris(bytes).ok();
      case 3:
        return DecodeSolution(bytes).ok();
      default:
        return DecodeTimePulse(bytes).ok();
    }
  };
  std::mt19937_64 random(3);
  for (std::size_t kind = 0; kind < 5; ++kind) {
    EXPECT_TRUE(decode(kind, messages[kind])) << kind;
    for (std::size_t length = 0; length < messages[kind].size(); ++length) {
      EXPECT_FALSE(decode(kind, std::string_view(messages[kind]).substr(0, length))) << kind << " " << length;
    }
    for (int round = 0; round < 2000; ++round) {
      std::string bytes = messages[kind];
      for (int i = 0; i < 4; ++i) {
        bytes[random() % bytes.size()] = static_cast<char>(random());
      }
      static_cast<void>(decode(kind, bytes));
    }
  }
}

TEST(GnssTimePulse, IsGpstWhateverTheScale) {
  const auto message = [](std::uint32_t week, double second, bool utc, std::uint32_t system) {
    ByteWriter out;
    out.Write(week);
    out.Write(second);
    out.Write(static_cast<std::uint8_t>(utc));
    out.Write(system);
    return out.bytes();
  };
  EXPECT_EQ(*DecodeTimePulse(message(2288, 252'801, false, 0x01)), kStamp);
  EXPECT_EQ(*DecodeTimePulse(message(2288, 252'783, true, 0x01)), kStamp);   // 18 leap seconds
  EXPECT_EQ(*DecodeTimePulse(message(1264, 252'801, false, 0x08)), kStamp);  // GST
  EXPECT_EQ(*DecodeTimePulse(message(932, 252'787, false, 0x20)), kStamp);   // BDT
  EXPECT_FALSE(DecodeTimePulse(message(2288, 252'801, false, 0)).ok());
}

}  // namespace
}  // namespace alidade
