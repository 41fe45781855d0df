#include "gnss/model/satellite_measurement.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/format.h"
#include "gnss/base/constants.h"
#include "gnss/model/atmosphere.h"

namespace alidade {
namespace {

constexpr double kL1Hz = 1575.42e6;
constexpr double kMinPseudorangeM = 1e6;
constexpr double kMaxPseudorangeM = 1e9;

/// Bands in the order in which a single one is chosen: those with a broadcast group delay first.
std::string_view Bands(GnssSystem system) {
  switch (system) {
    case GnssSystem::kGalileo:
      return "1578";
    case GnssSystem::kBeidou:
      return "21675";
    case GnssSystem::kGlonass:
      return "12";
    default:
      return "125";
  }
}

/// Second bands of an ionosphere-free pair by preference; the first is Bands()[0].
std::string_view SecondBands(GnssSystem system) {
  switch (system) {
    case GnssSystem::kGalileo:
      return "57";
    case GnssSystem::kBeidou:
      return "67";
    case GnssSystem::kGlonass:
      return "2";
    default:
      return "25";
  }
}

/// The signal with a pseudorange in a band: civil C/A first, or, for a pair, P(Y) first, which broadcast
/// clocks refer to; then the file's order.
const SignalObservation* InBand(const SatelliteObservation& observed, char band, double min_cn0, bool pair) {
  const std::string_view preference = pair ? "WPCI" : "CPWI";
  const auto rank = [&](const SignalObservation& s) {
    return std::min(preference.find(s.signal.attribute), preference.size());
  };
  const SignalObservation* best = nullptr;
  for (const SignalObservation& signal : observed.signals) {
    const double range = signal.pseudorange_m.value_or(0);
    if (signal.signal.band != band || !(range > kMinPseudorangeM && range < kMaxPseudorangeM) ||
        signal.cn0_dbhz.value_or(min_cn0) < min_cn0) {
      continue;
    }
    if (best == nullptr || rank(signal) < rank(*best)) {
      best = &signal;
    }
  }
  return best;
}

bool HasDoppler(const SignalObservation& signal) {
  return signal.doppler_hz && std::isfinite(*signal.doppler_hz);
}

/// Doppler of the chosen signal, else of another one of its band.
const SignalObservation* WithDoppler(const SatelliteObservation& observed, const SignalObservation& chosen) {
  const SignalObservation* found = HasDoppler(chosen) ? &chosen : nullptr;
  for (const SignalObservation& signal : observed.signals) {
    if (found == nullptr && signal.signal.band == chosen.signal.band && HasDoppler(signal)) {
      found = &signal;
    }
  }
  return found;
}

/// A deviation that a receiver reports, times `scale`; nothing where it is none.
std::optional<double> ReportedDeviation(const std::optional<double>& reported, double scale) {
  return reported && std::isfinite(*reported) && *reported > 0 ? std::optional(scale * *reported)
                                                               : std::nullopt;
}

}  // namespace

void MeasurementCounts::Add(const MeasurementCounts& other) {
  no_ephemeris += other.no_ephemeris;
  unhealthy += other.unhealthy;
  no_signal += other.no_signal;
  unused_system += other.unused_system;
}

std::string Describe(const MeasurementCounts& counts) {
  return Format("%d without ephemeris, %d unhealthy, %d without signal", counts.no_ephemeris,
                counts.unhealthy, counts.no_signal);
}

double ObservationVariance(double zenith_std, double elevation_rad, double cn0_dbhz,
                           std::optional<double> reported_std) {
  const double sine = std::max(std::sin(elevation_rad), 0.05);
  const double by_elevation = 0.5 * (1 + 1 / (sine * sine));
  if (reported_std) {
    return *reported_std * *reported_std * by_elevation;
  }
  const double by_strength = cn0_dbhz > 0 ? std::clamp(std::pow(10.0, (45 - cn0_dbhz) / 10), 0.5, 1000.0) : 1;
  return zenith_std * zenith_std * by_elevation * by_strength;
}

MeasurementBuilder::MeasurementBuilder(std::shared_ptr<const SatelliteCatalog> catalog,
                                       GnssCorrectionOptions options, std::map<int, int> glonass_channels)
    : catalog_(std::move(catalog)),
      options_(std::move(options)),
      glonass_channels_(std::move(glonass_channels)) {}

std::optional<double> MeasurementBuilder::Frequency(SatelliteId satellite, char band) const {
  std::optional<int> channel;
  if (satellite.system == GnssSystem::kGlonass) {
    const auto found = glonass_channels_.find(satellite.number);
    channel = found != glonass_channels_.end() ? std::optional(found->second)
                                               : catalog_->GlonassChannel(satellite.number);
  }
  return CarrierFrequencyHz(satellite.system, band, channel);
}

MeasurementBuilder::SignalChoice MeasurementBuilder::Choose(const SatelliteObservation& observed) const {
  const GnssSystem system = observed.satellite.system;
  const bool pair = options_.ionosphere == IonosphereMode::kFree;
  SignalChoice choice;
  for (const char band : Bands(system)) {
    choice.first =
        choice.first == nullptr ? InBand(observed, band, options_.min_cn0_dbhz, pair) : choice.first;
    if (pair) {
      break;  // a pair has the first band or is none
    }
  }
  for (const char band : SecondBands(system)) {
    choice.second = pair && choice.second == nullptr ? InBand(observed, band, options_.min_cn0_dbhz, pair)
                                                     : choice.second;
  }
  if (choice.first != nullptr) {
    choice.f1 = Frequency(observed.satellite, choice.first->signal.band).value_or(0);
  }
  if (choice.second != nullptr) {
    choice.f2 = Frequency(observed.satellite, choice.second->signal.band).value_or(0);
  }
  choice.usable = choice.f1 > 0 && (!pair || choice.f2 > 0);
  return choice;
}

std::optional<SatelliteMeasurement> MeasurementBuilder::PrepareSatellite(TimeNs tag_ns,
                                                                         const SatelliteObservation& observed,
                                                                         MeasurementCounts* left_out) const {
  const SignalChoice choice = Choose(observed);
  if (!choice.usable) {
    ++left_out->no_signal;
    return std::nullopt;
  }
  const SignalObservation& first = *choice.first;
  const SatelliteFix fix = catalog_->AtTransmission(observed.satellite, first.signal, tag_ns,
                                                    *first.pseudorange_m, choice.second != nullptr);
  if (fix.fault != SatelliteFault::kNone) {
    ++(fix.fault == SatelliteFault::kUnhealthy ? left_out->unhealthy : left_out->no_ephemeris);
    return std::nullopt;
  }
  SatelliteMeasurement m;
  m.satellite = observed.satellite;
  m.signal = first.signal;
  m.frequency_hz = choice.f1;
  m.pseudorange_m = *first.pseudorange_m;
  m.cn0_dbhz = first.cn0_dbhz.value_or(0);
  m.state = fix.state;
  m.reported_std_m = ReportedDeviation(first.pseudorange_std_m, 1);
  GroupDelay delay = GroupDelayOf(fix, m.satellite, m.signal);
  if (choice.second != nullptr) {
    // P_if = a1 P1 + a2 P2 with a1 = f1^2 / (f1^2 - f2^2), a2 = 1 - a1.
    const double a1 = choice.f1 * choice.f1 / (choice.f1 * choice.f1 - choice.f2 * choice.f2);
    const double a2 = 1 - a1;
    const GroupDelay other = GroupDelayOf(fix, m.satellite, choice.second->signal);
    m.pseudorange_m = a1 * m.pseudorange_m + a2 * *choice.second->pseudorange_m;
    delay = {a1 * delay.delay_m + a2 * other.delay_m,
             std::hypot(a1 * delay.deviation_m, a2 * other.deviation_m)};
    m.noise_gain = std::hypot(a1, a2);
  }
  m.group_delay_m = delay.delay_m;
  m.ephemeris_variance = fix.accuracy_m * fix.accuracy_m + delay.deviation_m * delay.deviation_m;
  if (const SignalObservation* doppler = WithDoppler(observed, first)) {
    const double wavelength = kSpeedOfLight / choice.f1;
    m.range_rate_mps = -wavelength * *doppler->doppler_hz;
    m.reported_rate_std_mps = ReportedDeviation(doppler->doppler_std_hz, wavelength);
  }
  return m;
}

EpochMeasurements MeasurementBuilder::Prepare(const ObservationEpoch& epoch) const {
  EpochMeasurements result;
  result.tag_ns = epoch.stamp_ns;
  for (const SatelliteObservation& observed : epoch.satellites) {
    if (options_.systems.find(Letter(observed.satellite.system)) == std::string::npos) {
      ++result.left_out.unused_system;
    } else if (auto measurement = PrepareSatellite(epoch.stamp_ns, observed, &result.left_out)) {
      result.satellites.push_back(*measurement);
    }
  }
  return result;
}

/// Ionospheric delay on L1 by the broadcast model; 0 = there is none.
double MeasurementBuilder::IonosphereL1(const GeodeticPosition& receiver, const Direction& direction,
                                        TimeNs stamp_ns) const {
  const NavigationData& navigation = catalog_->navigation();
  if (options_.ionosphere != IonosphereMode::kBroadcast) {
    return 0;
  }
  if (navigation.gps_ionosphere) {
    return KlobucharDelayL1(*navigation.gps_ionosphere, receiver, direction, stamp_ns);
  }
  return navigation.beidou_ionosphere
             ? BeidouKlobucharDelayL1(*navigation.beidou_ionosphere, receiver, direction, stamp_ns)
             : 0;
}

void MeasurementBuilder::Locate(const Eigen::Vector3d& position_E, EpochMeasurements* epoch) const {
  const EnuFrame frame = EnuFrame::At(position_E);
  const GeodeticPosition receiver = ToGeodetic(position_E);
  for (SatelliteMeasurement& m : epoch->satellites) {
    m.direction = DirectionTo(frame, m.state.position_E);
    const double elevation = m.direction.elevation_rad;
    m.troposphere_m = TroposphereDelay(receiver, elevation, epoch->tag_ns);
    const double scale = kL1Hz * kL1Hz / (m.frequency_hz * m.frequency_hz);
    m.ionosphere_m = scale * IonosphereL1(receiver, m.direction, epoch->tag_ns);
    constexpr double kUnmodelledM = 5;
    double ionosphere_std = m.ionosphere_m > 0 ? 0.5 * m.ionosphere_m : kUnmodelledM * scale;
    ionosphere_std = options_.ionosphere == IonosphereMode::kFree ? 0 : ionosphere_std;
    constexpr double kTroposphereShare = 0.05;  // wet delay that the standard atmosphere misses
    const double troposphere_std = kTroposphereShare * m.troposphere_m;
    const double factor = m.satellite.system == GnssSystem::kGlonass ? options_.glonass_factor : 1;
    const double noise =
        ObservationVariance(factor * options_.pseudorange_std_m, elevation, m.cn0_dbhz, m.reported_std_m);
    m.pseudorange_variance =
        m.noise_gain * m.noise_gain * noise +
        options_.model_std_scale * options_.model_std_scale *
            (m.ephemeris_variance + ionosphere_std * ionosphere_std + troposphere_std * troposphere_std);
    m.range_rate_variance = ObservationVariance(factor * options_.range_rate_std_mps, elevation, m.cn0_dbhz,
                                                m.reported_rate_std_mps);
  }
}

}  // namespace alidade
