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
// back. A decoder returns kInput with the reason when the bytes are torn or hold invalid values.

/// gnss_comm numbers satellites through the systems: GPS 1 to 32, GLONASS 33 to 59, Galileo 60 to 97, BeiDou
/// 98 to 160; it has no other systems. Empty for other satellites.
[[nodiscard]] std::optional<std::uint32_t> GnssCommNumber(SatelliteId satellite);
[[nodiscard]] std::optional<SatelliteId> SatelliteOfGnssCommNumber(std::uint32_t number);

/// GnssMeasMsg: one epoch. Satellites without a number and standard deviations are left out. Frequencies are
/// those of the signals, 0 where a GLONASS channel is unknown.
[[nodiscard]] std::string EncodeMeasurements(const ObservationEpoch& epoch,
                                             const std::map<int, int>& glonass_channels);
/// Deviations that the receiver reports are dropped, because RINEX has no field for them. `glonass_channels`
/// is completed from the frequencies. A signal with an unknown code is identified by its frequency, or
/// skipped; of several in one message the first counts.
Result<ObservationEpoch> DecodeMeasurements(std::string_view bytes, std::map<int, int>* glonass_channels);

/// GnssEphemMsg and GnssGloEphemMsg. Times are GPST for every system. Empty for a satellite without a number.
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

/// GnssTimePulseInfoMsg: GPST of the next pulse. An external trigger is LocalSensorExternalTrigger: the time
/// of the pulse in the clock of camera and IMU.
[[nodiscard]] std::string EncodeTimePulse(TimeNs pulse_ns);
Result<TimeNs> DecodeTimePulse(std::string_view bytes);
[[nodiscard]] std::string EncodeTrigger(TimeNs stamp_ns);
Result<TimeNs> DecodeTrigger(std::string_view bytes);

}  // namespace alidade
