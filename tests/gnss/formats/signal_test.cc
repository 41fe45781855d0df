#include "gnss/formats/signal.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(SatelliteIdTest, ReadsRinexNames) {
  EXPECT_EQ(*ParseSatellite("G07"), (SatelliteId{GnssSystem::kGps, 7}));
  EXPECT_EQ(*ParseSatellite("C 8"), (SatelliteId{GnssSystem::kBeidou, 8}));
  EXPECT_EQ(*ParseSatellite(" 12"), (SatelliteId{GnssSystem::kGps, 12}));
  EXPECT_EQ(ToString(SatelliteId{GnssSystem::kQzss, 2}), "J02");
  for (const char* bad : {"", "G", "G0", "G00", "X07", "G7 ", "G-1", "G1x", "G123", "   "}) {
    EXPECT_FALSE(ParseSatellite(bad).has_value()) << bad;
  }
}

TEST(SignalTest, FrequenciesAreThoseOfRinex) {
  EXPECT_DOUBLE_EQ(*CarrierFrequencyHz(GnssSystem::kGps, '1', {}), 1575.42e6);
  EXPECT_DOUBLE_EQ(*CarrierFrequencyHz(GnssSystem::kBeidou, '2', {}), 1561.098e6);
  EXPECT_DOUBLE_EQ(*CarrierFrequencyHz(GnssSystem::kBeidou, '1', {}), 1575.42e6);
  EXPECT_DOUBLE_EQ(*CarrierFrequencyHz(GnssSystem::kGlonass, '1', -7), 1598.0625e6);
  EXPECT_DOUBLE_EQ(*CarrierFrequencyHz(GnssSystem::kGlonass, '2', 6), 1248.625e6);
  EXPECT_FALSE(CarrierFrequencyHz(GnssSystem::kGlonass, '1', {}).has_value());
  EXPECT_FALSE(CarrierFrequencyHz(GnssSystem::kGps, '7', {}).has_value());
}

TEST(SignalTest, BeidouB1IOfRinex302IsBand2) {
  EXPECT_EQ(ToString(CanonicalSignal(GnssSystem::kBeidou, {'1', 'I'}, 3.02)), "2I");
  EXPECT_EQ(ToString(CanonicalSignal(GnssSystem::kBeidou, {'1', 'X'}, 3.02)), "2X");
  EXPECT_EQ(ToString(CanonicalSignal(GnssSystem::kBeidou, {'1', 'X'}, 3.04)), "1X");
  EXPECT_EQ(ToString(CanonicalSignal(GnssSystem::kBeidou, {'1', 'P'}, 3.04)), "1P");
  EXPECT_EQ(ToString(CanonicalSignal(GnssSystem::kGps, {'1', 'C'}, 3.02)), "1C");
}

}  // namespace
}  // namespace alidade
