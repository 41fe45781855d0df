#pragma once

#include <optional>
#include <string>

#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;
class LogHasher;

/// Reads folder gnss0 of `mav`, if it exists: sensor.yaml and the RINEX files it names (default obs.rnx and
/// nav.rnx) into the GNSS part of `dataset`. Keys of sensor.yaml:
///
///   p_BA            antenna in the body frame [m], three numbers; `unknown` counts as zero
///   time_offset_s   t_imu = t_GPST + offset, default 0
///   anchor_E        optional: ECEF origin [m] of the ENU frame that the truth stands in
///   approximate_position_E  optional: ECEF [m], where positioning starts; default: the observations' header
///   observations    file; navigation, orbits (SP3), clocks (CLK): file or list of files, in the folder
///
/// Other keys, and what the readers of the files pass over, are remarks. Errors (kInput): a key's value, a
/// file that cannot be read.
Status ReadGnssFolder(const std::string& mav, const DatasetStorage& storage, Dataset* dataset);

/// Writes sensor.yaml, obs.rnx and nav.rnx, if there is GNSS. The navigation file holds broadcast ephemerides
/// only.
Status WriteGnssFolder(const Dataset& dataset, const std::string& mav);

/// The text of sensor.yaml with the file names that WriteGnssFolder uses.
[[nodiscard]] std::string GnssSensorYaml(const GnssReceiver& receiver,
                                         const std::optional<Eigen::Vector3d>& approximate_position_E);

/// The receiver's keys of a sensor.yaml, without reading the files it names.
struct GnssSheet {
  GnssReceiver receiver;
  std::optional<Eigen::Vector3d> approximate_position_E;
};
/// kInput as ReadGnssFolder; `where` stands for the file in messages.
Result<GnssSheet> ParseGnssSheet(const std::string& text, const std::string& where);

/// Receiver, observations and broadcast ephemerides; precise products are not part of it. Nothing without
/// GNSS.
Status DigestGnss(const MeasurementLog& log, const LogTables& tables, LogHasher* hasher);

/// Rate, satellites, span, whether the ephemerides serve, and the clock by the courses driven; nothing
/// without GNSS.
void CheckGnss(const Dataset& dataset, Findings* findings);

}  // namespace alidade
