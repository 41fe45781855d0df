#include "gnss/formats/signal.h"

namespace alidade {
namespace {

struct Band {
  GnssSystem system;
  char band;
  double frequency_hz;
};

constexpr double kL1 = 1575.42e6;
constexpr double kL2 = 1227.60e6;
constexpr double kL5 = 1176.45e6;
constexpr double kE5b = 1207.14e6;
constexpr double kE5 = 1191.795e6;

constexpr Band kBands[] = {{GnssSystem::kGps, '1', kL1},
                           {GnssSystem::kGps, '2', kL2},
                           {GnssSystem::kGps, '5', kL5},
                           {GnssSystem::kGalileo, '1', kL1},
                           {GnssSystem::kGalileo, '5', kL5},
                           {GnssSystem::kGalileo, '7', kE5b},
                           {GnssSystem::kGalileo, '8', kE5},
                           {GnssSystem::kGalileo, '6', 1278.75e6},
                           {GnssSystem::kBeidou, '1', kL1},
                           {GnssSystem::kBeidou, '2', 1561.098e6},
                           {GnssSystem::kBeidou, '5', kL5},
                           {GnssSystem::kBeidou, '7', kE5b},
                           {GnssSystem::kBeidou, '8', kE5},
                           {GnssSystem::kBeidou, '6', 1268.52e6},
                           {GnssSystem::kQzss, '1', kL1},
                           {GnssSystem::kQzss, '2', kL2},
                           {GnssSystem::kQzss, '5', kL5},
                           {GnssSystem::kQzss, '6', 1278.75e6},
                           {GnssSystem::kGlonass, '3', 1202.025e6},
                           {GnssSystem::kGlonass, '4', 1600.995e6},
                           {GnssSystem::kGlonass, '6', 1248.06e6},
                           {GnssSystem::kNavic, '5', kL5},
                           {GnssSystem::kNavic, '9', 2492.028e6},
                           {GnssSystem::kNavic, '1', kL1},
                           {GnssSystem::kSbas, '1', kL1},
                           {GnssSystem::kSbas, '5', kL5}};

}  // namespace

std::string ToString(SignalCode signal) {
  return {signal.band, signal.attribute};
}

std::optional<double> CarrierFrequencyHz(GnssSystem system, char band, std::optional<int> glonass_channel) {
  if (system == GnssSystem::kGlonass && (band == '1' || band == '2')) {
    // GLONASS ICD 5.1, 3.3.1.1
    if (!glonass_channel) {
      return std::nullopt;
    }
    return band == '1' ? 1602.0e6 + 0.5625e6 * *glonass_channel : 1246.0e6 + 0.4375e6 * *glonass_channel;
  }
  for (const Band& entry : kBands) {
    if (entry.system == system && entry.band == band) {
      return entry.frequency_hz;
    }
  }
  return std::nullopt;
}

SignalCode CanonicalSignal(GnssSystem system, SignalCode signal, double rinex_version) {
  const bool b1i =
      signal.attribute == 'I' || signal.attribute == 'Q' || (signal.attribute == 'X' && rinex_version < 3.03);
  if (system == GnssSystem::kBeidou && signal.band == '1' && b1i) {
    signal.band = '2';
  }
  return signal;
}

}  // namespace alidade
