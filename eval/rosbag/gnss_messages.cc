#include "eval/rosbag/gnss_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/format.h"
#include "core/gnss_config.h"
#include "eval/rosbag/gnss_message_time.h"
#include "gnss/base/constants.h"
#include "gnss/model/satellite_measurement.h"

namespace alidade {
namespace {

/// The systems in the order of gnss_comm's numbers, with how many each has.
struct NumberRange {
  GnssSystem system;
  int count;
};
constexpr std::array<NumberRange, 4> kRanges = {{{GnssSystem::kGps, 32},
                                                 {GnssSystem::kGlonass, 27},
                                                 {GnssSystem::kGalileo, 38},
                                                 {GnssSystem::kBeidou, 63}}};

/// Signals in the order of the code numbers that gnss_comm took over from RTKLIB; the first one is number 1.
constexpr std::array<std::string_view, 68> kCodes = {
    "1C", "1P", "1W", "1Y", "1M", "1N", "1S", "1L", "1E", "1A", "1B", "1X", "1Z", "2C", "2D", "2S", "2L",
    "2X", "2P", "2W", "2Y", "2M", "2N", "5I", "5Q", "5X", "7I", "7Q", "7X", "6A", "6B", "6C", "6X", "6Z",
    "6S", "6L", "8I", "8Q", "8X", "2I", "2Q", "6I", "6Q", "3I", "3Q", "3X", "1I", "1Q", "5A", "5B", "5C",
    "9A", "9B", "9C", "9X", "1D", "5D", "5P", "5Z", "6E", "7D", "7P", "7Z", "8D", "8P", "4A", "4B", "4X"};

constexpr std::uint8_t kPseudorangeValid = 1;
constexpr std::uint8_t kPhaseValid = 2;
/// More satellites than all systems together have in one message is nonsense.
constexpr std::uint32_t kMaxSatellites = 256;
constexpr double kGlonassL1Hz = 1602.0e6;
constexpr double kGlonassL1StepHz = 0.5625e6;
// Bounds of what a receiver may report; the models refuse more (core/gnss_config.h).
constexpr double kMinPseudorangeM = 1e6;
constexpr double kMaxPseudorangeM = 1e9;
constexpr double kMaxDopplerHz = 1e6;

std::uint8_t CodeNumber(SignalCode signal) {
  const auto found = std::find(kCodes.begin(), kCodes.end(), ToString(signal));
  return found == kCodes.end() ? 0 : static_cast<std::uint8_t>(found - kCodes.begin() + 1);
}

std::optional<SignalCode> SignalOf(GnssSystem system, std::uint8_t code, double frequency_hz) {
  constexpr double kRinex303 = 3.03;  // X of band 1 is then B1C, and B1I still moves to band 2
  if (code >= 1 && code <= kCodes.size()) {
    const std::string_view name = kCodes[code - 1u];
    return CanonicalSignal(system, {name[0], name[1]}, kRinex303);
  }
  constexpr double kSameHz = 1e3;
  for (const char band : {'1', '2', '5', '6', '7', '8'}) {
    const std::optional<double> known = CarrierFrequencyHz(system, band, std::nullopt);
    if (known && std::abs(*known - frequency_hz) < kSameHz) {
      return SignalCode{band, 'X'};
    }
  }
  return std::nullopt;
}

double OrZero(const std::optional<double>& value) {
  return value.value_or(0);
}

/// The deviation that a receiver reports of its measurement; 0 where there is none. Without a report: the
/// deviation that the estimators assume by default, by C/N0. The elevation is left to the reader of the
/// message, as receivers do.
double DeviationOf(const std::optional<double>& measured, const std::optional<double>& reported,
                   double zenith_std, const std::optional<double>& cn0_dbhz) {
  constexpr double kZenith = std::numbers::pi / 2;
  return measured ? std::sqrt(ObservationVariance(reported.value_or(zenith_std), kZenith, OrZero(cn0_dbhz),
                                                  reported))
                  : 0;
}

double PseudorangeDeviationM(const SignalObservation& signal) {
  return DeviationOf(signal.pseudorange_m, signal.pseudorange_std_m,
                     GnssCorrectionOptions().pseudorange_std_m, signal.cn0_dbhz);
}

double DopplerDeviationHz(const SignalObservation& signal, double frequency_hz) {
  const double zenith_hz = GnssCorrectionOptions().range_rate_std_mps * frequency_hz / kSpeedOfLight;
  return DeviationOf(signal.doppler_hz, signal.doppler_std_hz, zenith_hz, signal.cn0_dbhz);
}

/// A usable value: finite, not zero, within the bounds.
std::optional<double> Meaningful(double value, double low, double high) {
  return value != 0 && value >= low && value <= high ? std::optional(value) : std::nullopt;
}

/// The entry of an array that may be shorter than the others.
template <typename Value>
Value At(const std::vector<Value>& values, std::size_t i, Value otherwise) {
  return i < values.size() ? values[i] : otherwise;
}

void LearnChannel(int number, char band, double frequency_hz, std::map<int, int>* channels) {
  const double channel = (frequency_hz - kGlonassL1Hz) / kGlonassL1StepHz;
  if (band == '1' && channel > -7.5 && channel < 6.5) {
    channels->try_emplace(number, static_cast<int>(std::lround(channel)));
  }
}

/// The arrays of one GnssObsMsg.
struct ObsArrays {
  std::vector<double> frequency, cn0, pseudorange, phase, doppler;
  std::vector<std::uint8_t> loss_of_lock, code, status;

  explicit ObsArrays(ByteReader* in) {
    frequency = in->Array<double>();
    cn0 = in->Array<double>();
    loss_of_lock = in->Array<std::uint8_t>();
    code = in->Array<std::uint8_t>();
    pseudorange = in->Array<double>();
    static_cast<void>(in->Array<double>());  // its deviation
    phase = in->Array<double>();
    static_cast<void>(in->Array<double>());
    doppler = in->Array<double>();
    static_cast<void>(in->Array<double>());
    status = in->Array<std::uint8_t>();
  }
};

SatelliteObservation MakeObservation(SatelliteId satellite, const ObsArrays& arrays,
                                     std::map<int, int>* glonass_channels) {
  SatelliteObservation observed{satellite, {}};
  for (std::size_t i = 0; i < arrays.code.size() || i < arrays.frequency.size(); ++i) {
    const double frequency_hz = At(arrays.frequency, i, 0.0);
    const std::optional<SignalCode> code =
        SignalOf(satellite.system, At(arrays.code, i, std::uint8_t{0}), frequency_hz);
    const bool known = code && std::any_of(observed.signals.begin(), observed.signals.end(),
                                           [&](const SignalObservation& s) { return s.signal == *code; });
    if (!code || known) {
      continue;
    }
    SignalObservation signal;
    signal.signal = *code;
    const std::uint8_t status = At(arrays.status, i, std::uint8_t{kPseudorangeValid | kPhaseValid});
    if ((status & kPseudorangeValid) != 0) {
      signal.pseudorange_m = Meaningful(At(arrays.pseudorange, i, 0.0), kMinPseudorangeM, kMaxPseudorangeM);
    }
    if ((status & kPhaseValid) != 0) {
      signal.phase_cycles = Meaningful(At(arrays.phase, i, 0.0), -1e10, 1e10);
    }
    signal.doppler_hz = Meaningful(At(arrays.doppler, i, 0.0), -kMaxDopplerHz, kMaxDopplerHz);
    signal.cn0_dbhz = Meaningful(At(arrays.cn0, i, 0.0), 0, 100);
    signal.loss_of_lock = At(arrays.loss_of_lock, i, std::uint8_t{0});
    if (satellite.system == GnssSystem::kGlonass) {
      LearnChannel(satellite.number, code->band, frequency_hz, glonass_channels);
    }
    observed.signals.push_back(signal);
  }
  std::sort(observed.signals.begin(), observed.signals.end(),
            [](const SignalObservation& a, const SignalObservation& b) { return a.signal < b.signal; });
  return observed;
}

}  // namespace

std::optional<std::uint32_t> GnssCommNumber(SatelliteId satellite) {
  int before = 0;
  for (const NumberRange& range : kRanges) {
    if (range.system == satellite.system) {
      const bool numbered = satellite.number >= 1 && satellite.number <= range.count;
      return numbered ? std::optional(static_cast<std::uint32_t>(before + satellite.number)) : std::nullopt;
    }
    before += range.count;
  }
  return std::nullopt;
}

std::optional<SatelliteId> SatelliteOfGnssCommNumber(std::uint32_t number) {
  std::uint32_t left = number;
  for (const NumberRange& range : kRanges) {
    const auto count = static_cast<std::uint32_t>(range.count);
    if (left >= 1 && left <= count) {
      return SatelliteId{range.system, static_cast<int>(left)};
    }
    left -= std::min(left, count);
  }
  return std::nullopt;
}

std::string EncodeMeasurements(const ObservationEpoch& epoch, const std::map<int, int>& glonass_channels) {
  ByteWriter body;
  std::uint32_t satellites = 0;
  for (const SatelliteObservation& observed : epoch.satellites) {
    const std::optional<std::uint32_t> number = GnssCommNumber(observed.satellite);
    if (!number) {
      continue;
    }
    ++satellites;
    const auto channel = glonass_channels.find(observed.satellite.number);
    std::vector<double> frequency, cn0, pseudorange, pseudorange_std, phase, doppler, doppler_std;
    std::vector<std::uint8_t> loss_of_lock, code, status;
    for (const SignalObservation& signal : observed.signals) {
      frequency.push_back(OrZero(CarrierFrequencyHz(
          observed.satellite.system, signal.signal.band,
          channel == glonass_channels.end() ? std::nullopt : std::optional(channel->second))));
      cn0.push_back(OrZero(signal.cn0_dbhz));
      loss_of_lock.push_back(signal.loss_of_lock);
      code.push_back(CodeNumber(signal.signal));
      pseudorange.push_back(OrZero(signal.pseudorange_m));
      pseudorange_std.push_back(PseudorangeDeviationM(signal));
      doppler_std.push_back(DopplerDeviationHz(signal, frequency.back()));
      phase.push_back(OrZero(signal.phase_cycles));
      doppler.push_back(OrZero(signal.doppler_hz));
      status.push_back(static_cast<std::uint8_t>((signal.pseudorange_m ? kPseudorangeValid : 0) |
                                                 (signal.phase_cycles ? kPhaseValid : 0)));
    }
    const std::vector<double> unknown(code.size(), 0.0);
    PutGnssTime(epoch.stamp_ns, &body);
    body.Write(*number);
    body.Array(frequency);
    body.Array(cn0);
    body.Array(loss_of_lock);
    body.Array(code);
    body.Array(pseudorange);
    body.Array(pseudorange_std);
    body.Array(phase);
    body.Array(unknown);
    body.Array(doppler);
    body.Array(doppler_std);
    body.Array(status);
  }
  ByteWriter out;
  out.Write(satellites);
  out.Raw(body.bytes());
  return std::move(out.bytes());
}

Result<ObservationEpoch> DecodeMeasurements(std::string_view bytes, std::map<int, int>* glonass_channels) {
  ByteReader in(bytes);
  const auto count = in.Read<std::uint32_t>();
  if (!in.ok() || count == 0 || count > kMaxSatellites) {
    return Status::Input(Format("found %u satellites, expected 1 to %u", count, kMaxSatellites));
  }
  ObservationEpoch epoch;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Result<TimeNs> time = TakeGnssTime(&in);
    const auto number = in.Read<std::uint32_t>();
    const ObsArrays arrays(&in);
    if (!in.ok()) {
      return Status::Input("is torn");
    }
    ALIDADE_RETURN_IF_ERROR(time.status());
    if (i > 0 && *time != epoch.stamp_ns) {
      return Status::Input("satellites of two times in one message, expected one epoch");
    }
    epoch.stamp_ns = *time;
    const std::optional<SatelliteId> satellite = SatelliteOfGnssCommNumber(number);
    const bool known = satellite && std::any_of(epoch.satellites.begin(), epoch.satellites.end(),
                                                [&](const auto& s) { return s.satellite == *satellite; });
    if (satellite && !known) {
      epoch.satellites.push_back(MakeObservation(*satellite, arrays, glonass_channels));
    }
  }
  std::sort(epoch.satellites.begin(), epoch.satellites.end(),
            [](const auto& a, const auto& b) { return a.satellite < b.satellite; });
  return epoch;
}

}  // namespace alidade
