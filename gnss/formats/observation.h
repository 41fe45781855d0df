#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gnss/base/gnss_time.h"
#include "gnss/base/text_file.h"
#include "gnss/formats/signal.h"

namespace alidade {

/// What a receiver measured on one signal. Empty = not measured.
struct SignalObservation {
  SignalCode signal;
  std::optional<double> pseudorange_m;
  std::optional<double> phase_cycles;
  std::optional<double> doppler_hz;  ///< positive when the satellite approaches
  std::optional<double> cn0_dbhz;
  std::uint8_t loss_of_lock = 0;  ///< RINEX LLI bits of the phase
  /// Deviations that the receiver reports (not in RINEX; for other sources).
  std::optional<double> pseudorange_std_m;
  std::optional<double> doppler_std_hz;
};

struct SatelliteObservation {
  SatelliteId satellite;
  std::vector<SignalObservation> signals;  ///< sorted by code, each once
};

/// All measurements of one receiver epoch.
struct ObservationEpoch {
  TimeNs stamp_ns = 0;  ///< the receiver's own time tag as GPST; true time = tag - receiver clock bias
  std::vector<SatelliteObservation> satellites;  ///< sorted, each once
};

/// Content of an observation file.
struct ObservationFile {
  double version = 0;
  std::string marker;
  std::optional<Eigen::Vector3d> approximate_position_E;  ///< marker, ECEF [m]
  Eigen::Vector3d antenna_delta_hen =
      Eigen::Vector3d::Zero();           ///< antenna over marker: height, east, north [m]
  std::map<int, int> glonass_channels;   ///< number -> frequency channel
  std::optional<int> leap_seconds;       ///< of the header
  std::vector<ObservationEpoch> epochs;  ///< strictly rising stamps
  int events = 0;                        ///< event records passed over
  ReaderWarnings warnings;
};

}  // namespace alidade
