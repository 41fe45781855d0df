#include "gnss/formats/rinex_writer.h"

#include <gtest/gtest.h>

#include "gnss/formats/rinex_navigation.h"
#include "gnss/formats/rinex_observation.h"
#include "tests/gnss/model/synthetic_sky.h"

namespace alidade {
namespace {

constexpr TimeNs kStamp = 1'700'000'100 * kSecondNs;

TEST(RinexWriterTest, ObservationsReadBackToTheirThreeDecimals) {
  const NavigationData sky = test::SyntheticSky(kStamp);
  ObservationFile file;
  file.marker = "MARK";
  file.approximate_position_E = Eigen::Vector3d(3582105, 532590, 5232755);
  file.glonass_channels = {{3, -4}, {11, 6}};
  for (int k = 0; k < 3; ++k) {
    test::SyntheticReceiver receiver;
    receiver.stamp_ns = kStamp + k * kSecondNs / 10;
    file.epochs.push_back(test::Observe(sky, receiver));
  }
  // One satellite lacks a value, another has a second signal.
  file.epochs[1].satellites[0].signals[0].doppler_hz.reset();
  SignalObservation second = file.epochs[1].satellites[1].signals[0];
  second.signal = {'5', 'Q'};
  second.phase_cycles = 123456789.125;
  file.epochs[1].satellites[1].signals.push_back(second);

  const Result<ObservationFile> read = ParseRinexObservation("memory", FormatRinexObservation(file));
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(read->warnings.count, 0);
  EXPECT_EQ(read->marker, "MARK");
  EXPECT_EQ(read->glonass_channels, file.glonass_channels);
  ASSERT_EQ(read->epochs.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(read->epochs[k].stamp_ns, file.epochs[k].stamp_ns);
    ASSERT_EQ(read->epochs[k].satellites.size(), file.epochs[k].satellites.size());
    for (std::size_t i = 0; i < file.epochs[k].satellites.size(); ++i) {
      const SatelliteObservation& expected = file.epochs[k].satellites[i];
      const SatelliteObservation& found = read->epochs[k].satellites[i];
      EXPECT_EQ(found.satellite, expected.satellite);
      ASSERT_EQ(found.signals.size(), expected.signals.size());
      for (std::size_t s = 0; s < expected.signals.size(); ++s) {
        EXPECT_EQ(found.signals[s].signal, expected.signals[s].signal);
        EXPECT_NEAR(*found.signals[s].pseudorange_m, *expected.signals[s].pseudorange_m, 0.00051);
        EXPECT_EQ(found.signals[s].doppler_hz.has_value(), expected.signals[s].doppler_hz.has_value());
        EXPECT_EQ(found.signals[s].phase_cycles, expected.signals[s].phase_cycles);
      }
    }
  }
}

TEST(RinexWriterTest, EphemeridesReadBackToRounding) {
  NavigationData data = test::SyntheticSky(kStamp);
  for (auto& [id, list] : data.kepler) {
    list.front().omega = std::remainder(list.front().omega, 2 * M_PI);  // as messages have it
  }
  data.gps_ionosphere = KlobucharParameters{{1.2e-8, 1.5e-8, -6e-8, -1.2e-7}, {9.4e4, 4.9e4, -2e5, -3.3e5}};
  data.leap_seconds = 18;
  GlonassEphemeris glonass;
  glonass.satellite.number = 7;
  glonass.toe_ns = glonass.transmission_ns = 1'699'999'218 * kSecondNs;
  glonass.position_m = Eigen::Vector3d(1.2e7, -1.5e7, 1.68e7);
  glonass.velocity_mps = Eigen::Vector3d(1000, 2000.5, 900);
  glonass.clock_bias_s = 1.25e-5;
  glonass.channel = -3;
  data.glonass[7].push_back(glonass);
  const Result<NavigationData> read = ParseRinexNavigation("memory", FormatRinexNavigation(data));
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(read->warnings.count, 0);
  EXPECT_EQ(read->leap_seconds, 18);
  EXPECT_EQ(read->gps_ionosphere->beta, data.gps_ionosphere->beta);
  ASSERT_EQ(read->ephemerides(), data.ephemerides());
  for (const auto& [id, list] : data.kepler) {
    const KeplerEphemeris& found = read->kepler.at(id).front();
    EXPECT_EQ(found.toe_ns, list.front().toe_ns);
    EXPECT_EQ(found.message, list.front().message);
    const SatelliteState expected = PropagateKepler(list.front(), kStamp);
    const SatelliteState state = PropagateKepler(found, kStamp);
    EXPECT_LT((state.position_E - expected.position_E).norm(), 1e-3) << ToString(id);
    EXPECT_NEAR(state.clock_m, expected.clock_m, 1e-3);
    EXPECT_NEAR(found.group_delay_s[0], list.front().group_delay_s[0], 1e-15);
  }
  const GlonassEphemeris& found = read->glonass.at(7).front();
  EXPECT_EQ(found.toe_ns, glonass.toe_ns);
  EXPECT_EQ(found.channel, -3);
  EXPECT_LT((found.position_m - glonass.position_m).norm(), 1e-3);
}

}  // namespace
}  // namespace alidade
