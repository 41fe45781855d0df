#include "eval/comparison/innovations.h"

#include <map>
#include <utility>

#include "eval/metrics/error_statistics.h"
#include "eval/metrics/nees.h"

namespace alidade {

Innovations InnovationsOf(Sensor sensor, const FrameStatistics& frame) {
  if (sensor == Sensor::kCamera) {
    return {frame.nis, frame.nis_dof};
  }
  if (sensor == Sensor::kGnss) {
    return {frame.gnss_nis, frame.gnss_nis_dof};
  }
  return {frame.sensors[sensor].nis, frame.sensors[sensor].nis_dof};
}

std::vector<Sensor> SensorsBetweenFrames() {
  std::vector<Sensor> sensors = {Sensor::kGnss};
  ForEachSensorEntry([&](auto, Sensor sensor) { sensors.push_back(sensor); });
  return sensors;
}

InnovationSummary SummarizeInnovations(Sensor sensor, const std::vector<RunRecord>& records) {
  std::map<int, std::pair<double, double>> bands;  // of a sum of squares, by its number
  std::vector<double> rows;
  double nis = 0, dof = 0, inside = 0;
  for (const RunRecord& record : records) {
    const auto [squared, count] = InnovationsOf(sensor, record.statistics);
    if (count > 0) {
      const auto [band, added] = bands.try_emplace(count);
      band->second = added ? NeesBand(count, 1) : band->second;
      inside += squared >= band->second.first && squared <= band->second.second ? 1 : 0;
      nis += squared;
      dof += count;
      rows.push_back(count);
    }
  }
  InnovationSummary summary;
  if (!rows.empty()) {
    summary.ratio = nis / dof;
    summary.inside = inside / static_cast<double>(rows.size());
    const double median = *Percentile(rows, 0.5);
    const std::pair<double, double> band = bands.at(static_cast<int>(median));
    summary.band.emplace(band.first / median, band.second / median);
  }
  return summary;
}

}  // namespace alidade
