#pragma once

#include <string>

#include "core/position_fix.h"
#include "eval/dataset/dataset.h"

namespace alidade {

class Findings;
class LogHasher;

/// Reads the folders fix0, fix1, ... of `mav`, without a gap in their numbers, into rig.fixes and fixes of
/// `dataset`. Keys of sensor.yaml:
///
///   sensor_type     position, may be left out
///   p_BA            the point that is measured in the body frame [m], three numbers; `unknown` is zero
///   time_offset_s   t_imu = t_fix + offset, default 0
///   anchor_llh_deg  latitude [deg], longitude [deg], height above the ellipsoid [m] of the origin of the
///                   ENU frame of the fixes; without it they are in a gravity-aligned frame of their own
///   positions       file in the folder, default data.csv; .pos: RTKLIB's; .nmea, .txt, .log: NMEA 0183.
///                   The stamps of RTKLIB and NMEA are GPST, and without an anchor in the sheet theirs is
///                   the first position
///   date            YYYY-MM-DD, UTC, of NMEA sentences that hold no date
///
/// Other keys are remarks. Errors (kInput): a key's value with file:line:column; of data.csv file and line of
/// a torn row, a stamp that does not increase, a covariance that is not positive definite; those of
/// ReadPositionRows and ReadNmeaFile.
Status ReadFixFolders(const std::string& mav, const DatasetStorage& storage, Dataset* dataset);

/// Writes fix0, fix1, ... with sensor.yaml and data.csv.
Status WriteFixFolders(const Dataset& dataset, const std::string& mav);

/// The text of sensor.yaml.
[[nodiscard]] std::string FixSensorYaml(const FixSensor& sensor);
/// The sensor as a sensor.yaml describes it; the file it names does not matter. `where` stands for the file
/// in messages.
Result<FixSensor> ParseFixSheet(const std::string& text, const std::string& where);

/// Sensors and fixes; nothing for a log without fixes.
Status DigestFixes(const MeasurementLog& log, const LogTables& tables, LogHasher* hasher);

/// Rate, gaps, deviations and frames of the position fixes; nothing without them.
void CheckFixes(const Dataset& dataset, Findings* findings);

/// Puts the fixes into the order of MeasurementLog::fixes.
void SortFixes(const std::vector<FixSensor>& sensors, std::vector<PositionFix>* fixes);

}  // namespace alidade
