#include <optional>
#include <vector>

#include "core/format.h"
#include "eval/dataset/dataset_findings.h"
#include "eval/dataset/dataset_gnss.h"
#include "eval/dataset/gnss_motion.h"
#include "eval/dataset/log_tables.h"
#include "eval/dataset/sensor_table.h"
#include "gnss/positioning/time_check.h"

namespace alidade {
namespace {

/// Whether the ephemerides serve at the epochs' times.
void CheckEphemerides(const GnssLog& log, Findings* findings) {
  const GnssCoverage coverage = CheckCoverage(log);
  if (coverage.usable_epochs < coverage.epochs) {
    findings->Warning(Format("gnss0: %d of %d sampled epochs have no satellite that can be used (",
                             coverage.epochs - coverage.usable_epochs, coverage.epochs) +
                      Describe(coverage.faults) +
                      Format("); the nearest ephemeris is %.1f h away", coverage.nearest_s / 3600));
  }
}

/// A clock that is off by less than the spans show.
void CheckCourse(const Dataset& dataset, Findings* findings) {
  const std::vector<CourseChange> courses = CourseChanges(*dataset.gnss);
  if (courses.empty()) {
    return;
  }
  const Result<VerticalTurns> turns = VerticalTurns::Of(TablesOf(dataset).imu);
  if (!turns.ok()) {  // a file that cannot be read again is reported by its next reader
    return;
  }
  const std::optional<CourseShift> found =
      ShiftByCourse(courses, *turns, SecondsToNs(dataset.rig.gnss.time_offset_s));
  if (found) {
    findings->Warning(Format(
        "gnss0: time_offset_s: courses of the Doppler velocities follow the gyroscope with %+.0f s (%s) "
        "added (correlation %.2f of %d pairs of epochs), and do not as it is (%.2f): another clock?",
        SecondsBetween(0, found->shift.shift_ns), found->shift.name.c_str(), found->shifted.correlation,
        found->shifted.pairs, found->as_given.correlation));
  }
}

}  // namespace

void CheckGnss(const Dataset& dataset, Findings* findings) {
  if (dataset.gnss == nullptr) {
    return;
  }
  const std::vector<ObservationEpoch>& epochs = dataset.gnss->epochs;
  size_t satellites = 0;
  for (const ObservationEpoch& epoch : epochs) {
    satellites += epoch.satellites.size();
  }
  const TimeNs first_ns = epochs.front().stamp_ns;
  const TimeNs last_ns = epochs.back().stamp_ns;
  findings->Fact(Format("gnss0: %zu epochs, %.1f Hz, %.1f satellites each, %zu ephemerides", epochs.size(),
                        MeasuredRate(first_ns, last_ns, epochs.size()),
                        static_cast<double>(satellites) / static_cast<double>(epochs.size()),
                        dataset.gnss->catalog->navigation().ephemerides()));
  CheckRate("gnss0", MeasuredRate(first_ns, last_ns, epochs.size()), kGnssRates, findings);
  const TimeNs offset_ns = SecondsToNs(dataset.rig.gnss.time_offset_s);
  CheckEphemerides(*dataset.gnss, findings);
  if (!CheckSpan("gnss0", first_ns + offset_ns, last_ns + offset_ns, dataset, findings)) {
    return;
  }
  CheckTimeWithoutImu("gnss0", first_ns + offset_ns, last_ns + offset_ns, epochs.size(), dataset, findings);
  CheckTimeWithoutSensor("gnss0", first_ns + offset_ns, last_ns + offset_ns, epochs.size(), dataset,
                         findings);
  CheckCourse(dataset, findings);
}

}  // namespace alidade
