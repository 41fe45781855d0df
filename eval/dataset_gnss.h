#pragma once

#include <string>

#include "eval/dataset.h"

namespace alidade {

/// Reads gnss0: sensor.yaml and the RINEX files it names (default obs.rnx and nav.rnx) into the GNSS part of
/// `dataset`. Keys of sensor.yaml:
///
///   p_BA            antenna in the body frame [m], three numbers; `unknown` counts as zero
///   time_offset_s   t_imu = t_GPST + offset, default 0
///   anchor_E        optional: ECEF origin [m] of the ENU frame that the truth stands in
///   observations    file; navigation, orbits (SP3), clocks (CLK): file or list of files, in the folder
///
/// Other keys are remarks. Errors (kInput): a key's value, a file that cannot be read.
Status ReadGnssFolder(const std::string& folder, Dataset* dataset);

/// Writes sensor.yaml, obs.rnx and nav.rnx. The navigation file holds broadcast ephemerides alone.
Status WriteGnssFolder(const Dataset& dataset, const std::string& folder);

}  // namespace alidade
