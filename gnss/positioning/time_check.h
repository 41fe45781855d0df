#pragma once

#include "core/status.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// How the ephemerides of a log cover its epochs, from a sample of them.
struct GnssCoverage {
  int epochs = 0;            ///< looked at
  int usable_epochs = 0;     ///< with at least one satellite
  MeasurementCounts faults;  ///< satellites left out of them
  double nearest_s = 0;      ///< from an epoch to the nearest ephemeris, the least of all [s]
};
[[nodiscard]] GnssCoverage CheckCoverage(const GnssLog& log);

/// Whether the epochs' tags are GPST as the ephemerides count it. Errors (kInput), with the offset found, to
/// be added to the tags:
///
///   - no ephemeris covers an epoch, but whole multiples of 1024 weeks later (or earlier) they do: the
///     receiver's week number rolled over;
///   - single points fit by far better when the tags are shifted by whole seconds, as where UTC (GPST
///     less the leap seconds), TAI or BDT stands in the place of GPST.
[[nodiscard]] Status CheckTags(const GnssLog& log);

}  // namespace alidade
