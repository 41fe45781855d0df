#include "gnss/model/atmosphere.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alidade {
namespace {

constexpr double kDegree = M_PI / 180;

TimeNs At(int year, int month, int day, int hour, int minute) {
  return GpsTimeFromCalendar(TimeScale::kGps, {year, month, day, hour, minute}).value();
}

/// A widely used worked example of IS-GPS-200's algorithm: 23.784 m on L1.
TEST(IonosphereTest, KlobucharAgreesWithAPublishedExample) {
  const KlobucharParameters parameters{{0.3820e-7, 0.1490e-7, -0.1790e-6, 0},
                                       {0.1430e6, 0, -0.3280e6, 0.1130e6}};
  const double delay = KlobucharDelayL1(parameters, {40 * kDegree, -100 * kDegree, 0},
                                        {20 * kDegree, 210 * kDegree}, At(2000, 1, 1, 20, 45));
  EXPECT_NEAR(delay, 23.784, 2e-3);
}

TEST(IonosphereTest, NightIsFiveNanosecondsAtTheZenith) {
  const KlobucharParameters parameters{{0.3820e-7, 0.1490e-7, -0.1790e-6, 0},
                                       {0.1430e6, 0, -0.3280e6, 0.1130e6}};
  const GeodeticPosition here{40 * kDegree, 0, 0};
  const Direction zenith{90 * kDegree, 0};
  EXPECT_NEAR(KlobucharDelayL1(parameters, here, zenith, At(2000, 1, 1, 2, 0)), 1.5, 0.01);
  EXPECT_NEAR(BeidouKlobucharDelayL1(parameters, here, zenith, At(2000, 1, 1, 2, 0)),
              1.499 * std::pow(1561.098 / 1575.42, 2), 0.01);
}

/// On the day side both models are a cosine over the same parameters, once with the geomagnetic latitude,
/// once with the geographic one.
TEST(IonosphereTest, BeidouModelPeaksAtTwoInTheAfternoon) {
  const KlobucharParameters parameters{{3e-8, 0, 0, 0}, {0, 0, 0, 0}};
  const GeodeticPosition here{30 * kDegree, 114 * kDegree, 0};
  const Direction zenith{90 * kDegree, 0};
  const auto delay = [&](int hour, int minute) {
    return BeidouKlobucharDelayL1(parameters, here, zenith, At(2020, 6, 3, hour, minute));
  };
  const double peak = 299792458.0 * 3.5e-8 * std::pow(1561.098 / 1575.42, 2);
  EXPECT_NEAR(delay(6, 24), peak, 1e-3) << "14:00 local is 06:24 UTC at 114 deg";
  EXPECT_LT(delay(9, 24), 0.8 * peak);
  // The period's lower bound, 20 h: a quarter of it later only the night's delay is left.
  EXPECT_NEAR(delay(11, 25), 299792458.0 * 5e-9 * std::pow(1561.098 / 1575.42, 2), 1e-3);
  EXPECT_NEAR(
      BeidouKlobucharDelayL1(parameters, here, {30 * kDegree, 0}, At(2020, 6, 3, 6, 24)) / delay(6, 24), 1.75,
      0.1)
      << "slant factor at 30 deg";
}

/// Le Mans, 1994-01-01, 5 deg: Mercier and Perosanz, "Mesures GNSS", give 10.16 and 10.75.
TEST(TroposphereTest, NiellAgreesWithAPublishedExample) {
  const NiellMapping mapping =
      NiellMappingAt({48 * kDegree, 0.2 * kDegree, 68}, 5 * kDegree, At(1994, 1, 1, 0, 0));
  EXPECT_NEAR(mapping.hydrostatic, 10.16, 0.01);
  EXPECT_NEAR(mapping.wet, 10.75, 0.01);
}

TEST(TroposphereTest, ZenithDelayIsThatOfAStandardAtmosphere) {
  // Saastamoinen at sea level, 45 deg: 2.307 m hydrostatic; 70 % of 17.0 hPa at 15 degC add 0.12 m.
  EXPECT_NEAR(TroposphereDelay({45 * kDegree, 0, 0}, 90 * kDegree, At(2020, 6, 1, 0, 0)), 2.307 + 0.12, 0.01);
  EXPECT_LT(TroposphereDelay({45 * kDegree, 0, 5000}, 90 * kDegree, At(2020, 6, 1, 0, 0)), 1.4);
}

TEST(TroposphereTest, IsBoundedWhateverTheInput) {
  for (const double elevation : {-1.5, -0.1, 0.0, 0.02, 1.57}) {
    for (const double height : {-6.4e6, -500.0, 20e3, 2e7}) {
      const double delay = TroposphereDelay({-0.5, 1, height}, elevation, 0);
      EXPECT_TRUE(std::isfinite(delay) && delay > 0 && delay < 60)
          << elevation << " " << height << " " << delay;
    }
  }
}

}  // namespace
}  // namespace alidade
