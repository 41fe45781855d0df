#include "eval/rosbag/gnss_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "eval/rosbag/gnss_message_time.h"
#include "eval/rosbag/gnss_navigation_messages.h"
#include "eval/rosbag/gnss_receiver_messages.h"
#include "tests/eval/rosbag/gnss_samples.h"

namespace alidade {
namespace {

using test::Ephemeris;
using test::Glonass;
using test::kStamp;

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
