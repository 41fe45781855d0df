#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/status.h"
#include "gnss/formats/observation.h"

namespace alidade {

// Messages of gnss_comm (github.com/HKUST-Aerial-Robotics/gnss_comm), as the GVINS dataset has them, and
// back. A decoder returns kInput with the reason when the bytes are torn or hold invalid values.

/// gnss_comm numbers satellites through the systems: GPS 1 to 32, GLONASS 33 to 59, Galileo 60 to 97, BeiDou
/// 98 to 160; it has no other systems. Empty for other satellites.
[[nodiscard]] std::optional<std::uint32_t> GnssCommNumber(SatelliteId satellite);
[[nodiscard]] std::optional<SatelliteId> SatelliteOfGnssCommNumber(std::uint32_t number);

/// GnssMeasMsg: one epoch. Satellites without a number are left out. Frequencies are those of the signals, 0
/// where a GLONASS channel is unknown. Deviations of pseudorange [m] and Doppler [Hz] are those that the
/// receiver reported, else what ObservationVariance gives at the zenith for the estimators' default noise and
/// the C/N0; of the phase 0, unknown.
[[nodiscard]] std::string EncodeMeasurements(const ObservationEpoch& epoch,
                                             const std::map<int, int>& glonass_channels);
/// Deviations that the receiver reports are dropped, because RINEX has no field for them. `glonass_channels`
/// is completed from the frequencies. A signal with an unknown code is identified by its frequency, or
/// skipped; of several in one message the first counts.
Result<ObservationEpoch> DecodeMeasurements(std::string_view bytes, std::map<int, int>* glonass_channels);

}  // namespace alidade
