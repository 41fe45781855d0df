#include "gnss/model/atmosphere.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gnss/base/constants.h"

namespace alidade {
namespace {

double SecondsOfDay(TimeNs stamp_ns) {
  return static_cast<double>(((stamp_ns % kDayNs) + kDayNs) % kDayNs) * kNsToSeconds;
}

double WrapDay(double seconds) {
  const double wrapped = std::fmod(seconds, 86400.0);
  return wrapped < 0 ? wrapped + 86400 : wrapped;
}

double Polynomial(const std::array<double, 4>& c, double x) {
  return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
}

/// Marini's continued fraction, 1 at the zenith.
double Fraction(double sine, double a, double b, double c) {
  return (1 + a / (1 + b / (1 + c))) / (sine + a / (sine + b / (sine + c)));
}

// Niell 1996, tables 3 and 4: latitudes 15, 30, 45, 60, 75 deg.
using Row = std::array<double, 5>;
constexpr Row kHydrostaticMean[3] = {{1.2769934e-3, 1.2683230e-3, 1.2465397e-3, 1.2196049e-3, 1.2045996e-3},
                                     {2.9153695e-3, 2.9152299e-3, 2.9288445e-3, 2.9022565e-3, 2.9024912e-3},
                                     {62.610505e-3, 62.837393e-3, 63.721774e-3, 63.824265e-3, 64.258455e-3}};
constexpr Row kHydrostaticSeason[3] = {{0.0, 1.2709626e-5, 2.6523662e-5, 3.4000452e-5, 4.1202191e-5},
                                       {0.0, 2.1414979e-5, 3.0160779e-5, 7.2562722e-5, 11.723375e-5},
                                       {0.0, 9.0128400e-5, 4.3497037e-5, 84.795348e-5, 170.37206e-5}};
constexpr Row kWet[3] = {{5.8021897e-4, 5.6794847e-4, 5.8118019e-4, 5.9727542e-4, 6.1641693e-4},
                         {1.4275268e-3, 1.5138625e-3, 1.4572752e-3, 1.5007428e-3, 1.7599082e-3},
                         {4.3472961e-2, 4.6729510e-2, 4.3908931e-2, 4.4626982e-2, 5.4736038e-2}};

double AtLatitude(const Row& row, double latitude_deg) {
  const double place = std::clamp(std::abs(latitude_deg) / 15 - 1, 0.0, 4.0);
  const auto i = static_cast<std::size_t>(std::min(place, 3.0));
  const double share = place - static_cast<double>(i);
  return row[i] * (1 - share) + row[i + 1] * share;
}

double BoundedElevation(double elevation_rad) {
  return std::max(elevation_rad, 3 * M_PI / 180);
}

double BoundedHeight(double height_m) {
  return std::clamp(height_m, -100.0, 10e3);
}

}  // namespace

double KlobucharDelayL1(const KlobucharParameters& parameters, const GeodeticPosition& receiver,
                        const Direction& direction, TimeNs stamp_ns) {
  // All angles in semicircles but the azimuth.
  const double elevation = direction.elevation_rad / M_PI;
  const double psi = 0.0137 / (elevation + 0.11) - 0.022;
  const double latitude =
      std::clamp(receiver.latitude_rad / M_PI + psi * std::cos(direction.azimuth_rad), -0.416, 0.416);
  const double longitude =
      receiver.longitude_rad / M_PI + psi * std::sin(direction.azimuth_rad) / std::cos(latitude * M_PI);
  const double geomagnetic = latitude + 0.064 * std::cos((longitude - 1.617) * M_PI);
  const double time = WrapDay(43200 * longitude + SecondsOfDay(stamp_ns));
  const double slant = 1 + 16 * std::pow(0.53 - elevation, 3);
  const double amplitude = std::max(Polynomial(parameters.alpha, geomagnetic), 0.0);
  const double period = std::max(Polynomial(parameters.beta, geomagnetic), 72000.0);
  const double x = 2 * M_PI * (time - 50400) / period;
  const double day = std::abs(x) < 1.57 ? amplitude * (1 + x * x * (-0.5 + x * x / 24)) : 0;
  return kSpeedOfLight * slant * (5e-9 + day);
}

double BeidouKlobucharDelayL1(const KlobucharParameters& parameters, const GeodeticPosition& receiver,
                              const Direction& direction, TimeNs stamp_ns) {
  constexpr double kRatio = 6378.0 / (6378.0 + 375.0);
  constexpr double kToL1 = 1561.098 * 1561.098 / (1575.42 * 1575.42);
  const double bent = kRatio * std::cos(direction.elevation_rad);
  const double psi = M_PI / 2 - direction.elevation_rad - std::asin(bent);
  const double sine = std::sin(receiver.latitude_rad) * std::cos(psi) +
                      std::cos(receiver.latitude_rad) * std::sin(psi) * std::cos(direction.azimuth_rad);
  const double latitude = std::asin(std::clamp(sine, -1.0, 1.0));
  const double longitude =
      receiver.longitude_rad +
      std::asin(std::clamp(std::sin(psi) * std::sin(direction.azimuth_rad) / std::cos(latitude), -1.0, 1.0));
  const double semicircles = std::abs(latitude) / M_PI;
  const double amplitude = std::max(Polynomial(parameters.alpha, semicircles), 0.0);
  const double period = std::clamp(Polynomial(parameters.beta, semicircles), 72000.0, 172800.0);
  constexpr TimeNs kBdtOffsetNs = kGpstLessBdtS * kSecondNs;
  const double time = WrapDay(SecondsOfDay(stamp_ns - kBdtOffsetNs) + longitude * 43200 / M_PI);
  const double apart = time - 50400;
  const double day = std::abs(apart) < period / 4 ? amplitude * std::cos(2 * M_PI * apart / period) : 0;
  return kToL1 * kSpeedOfLight * (5e-9 + day) / std::sqrt(1 - bent * bent);
}

NiellMapping NiellMappingAt(const GeodeticPosition& receiver, double elevation_rad, TimeNs stamp_ns) {
  const double sine = std::sin(BoundedElevation(elevation_rad));
  const double latitude = receiver.latitude_rad * 180 / M_PI;
  const CalendarTime date = CalendarFromGpsTime(TimeScale::kGps, stamp_ns);
  const TimeNs new_year =
      GpsTimeFromCalendar(TimeScale::kGps, {std::clamp(date.year, 1980, 2099), 1, 1, 0, 0, 0, 0}).value();
  const double day = SecondsBetween(new_year, stamp_ns) / 86400 + 1;
  const double season = std::cos(2 * M_PI * ((day - 28) / 365.25 + (latitude < 0 ? 0.5 : 0)));
  std::array<double, 3> h{};
  std::array<double, 3> w{};
  for (std::size_t i = 0; i < 3; ++i) {
    h[i] = AtLatitude(kHydrostaticMean[i], latitude) - AtLatitude(kHydrostaticSeason[i], latitude) * season;
    w[i] = AtLatitude(kWet[i], latitude);
  }
  const double lift =
      (1 / sine - Fraction(sine, 2.53e-5, 5.49e-3, 1.14e-3)) * BoundedHeight(receiver.height_m) / 1e3;
  return {Fraction(sine, h[0], h[1], h[2]) + lift, Fraction(sine, w[0], w[1], w[2])};
}

double TroposphereDelay(const GeodeticPosition& receiver, double elevation_rad, TimeNs stamp_ns) {
  constexpr double kHumidity = 0.7;
  const double height = BoundedHeight(receiver.height_m);
  const double pressure = 1013.25 * std::pow(1 - 2.2557e-5 * height, 5.2568);
  const double temperature = 15.0 - 6.5e-3 * height + 273.15;
  const double vapour = 6.108 * kHumidity * std::exp((17.15 * temperature - 4684.0) / (temperature - 38.45));
  const double gravity = 1 - 0.00266 * std::cos(2 * receiver.latitude_rad) - 0.00028 * height / 1e3;
  const double hydrostatic = 0.0022768 * pressure / gravity;
  const double wet = 0.002277 * (1255 / temperature + 0.05) * vapour;
  const NiellMapping mapping = NiellMappingAt(receiver, elevation_rad, stamp_ns);
  return mapping.hydrostatic * hydrostatic + mapping.wet * wet;
}

}  // namespace alidade
