#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"
#include "gnss/formats/ephemeris.h"
#include "gnss/formats/observation.h"

namespace alidade {

// Messages of gnss_comm (github.com/HKUST-Aerial-Robotics/gnss_comm), as the GVINS dataset has them, and
// back. A decoder gives kInput with the reason when the bytes are torn or hold what no receiver says.

/// gnss_comm numbers satellites through the systems: GPS 1 to 32, GLONASS 33 to 59, Galileo 60 to 97, BeiDou
/// 98 to 160; it has no others. Nothing outside of these.
[[nodiscard]] std::optional<std::uint32_t> GnssCommNumber(SatelliteId satellite);
[[nodiscard]] std::optional<SatelliteId> SatelliteOfGnssCommNumber(std::uint32_t number);

/// GnssMeasMsg: one epoch. Satellites without a number are left out, and so are deviations. Frequencies are
/// those of the signals, 0 where a GLONASS channel is unknown.
[[nodiscard]] std::string EncodeMeasurements(const ObservationEpoch& epoch,
                                             const std::map<int, int>& glonass_channels);
/// Deviations that the receiver reports are dropped, as RINEX has no place for them. `glonass_channels`
/// learns from the frequencies. A signal whose code is unknown is told by its frequency, or passed over;
/// several times in one message: the first counts.
Result<ObservationEpoch> DecodeMeasurements(std::string_view bytes, std::map<int, int>* glonass_channels);

/// GnssEphemMsg and GnssGloEphemMsg. Times are GPST whatever the system. Nothing for a satellite without a
/// number.
[[nodiscard]] std::optional<std::string> EncodeEphemeris(const KeplerEphemeris& ephemeris);
[[nodiscard]] std::optional<std::string> EncodeEphemeris(const GlonassEphemeris& ephemeris);
Result<KeplerEphemeris> DecodeKeplerEphemeris(std::string_view bytes);
Result<GlonassEphemeris> DecodeGlonassEphemeris(std::string_view bytes);

/// StampedFloat64Array with the eight Klobuchar parameters.
[[nodiscard]] std::string EncodeIonosphere(TimeNs stamp_ns, const KlobucharParameters& parameters);
Result<KlobucharParameters> DecodeIonosphere(std::string_view bytes);

/// GnssPVTSolnMsg: the receiver's own solution.
struct ReceiverSolution {
  TimeNs stamp_ns = 0;  ///< GPST
  bool valid = false;
  int carrier = 0;  ///< 0 no carrier phase, 1 float, 2 fixed
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 0;  ///< above the ellipsoid
  double horizontal_accuracy_m = 0;
  double vertical_accuracy_m = 0;
};
[[nodiscard]] std::string EncodeSolution(const ReceiverSolution& solution);
Result<ReceiverSolution> DecodeSolution(std::string_view bytes);

/// GnssTimePulseInfoMsg: GPST of the next pulse. An external trigger is LocalSensorExternalTrigger: when the
/// pulse came by the clock of camera and IMU.
[[nodiscard]] std::string EncodeTimePulse(TimeNs pulse_ns);
Result<TimeNs> DecodeTimePulse(std::string_view bytes);
[[nodiscard]] std::string EncodeTrigger(TimeNs stamp_ns);
Result<TimeNs> DecodeTrigger(std::string_view bytes);

}  // namespace alidade
