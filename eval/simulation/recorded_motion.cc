#include "eval/simulation/recorded_motion.h"

#include <filesystem>
#include <utility>

#include "core/format.h"
#include "eval/files/input_file.h"
#include "eval/trajectory/trajectory_reader.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;

constexpr double kMinDurationSeconds = 1;

double DurationOf(const Trajectory& trajectory) {
  return SecondsBetween(trajectory.points.front().stamp_ns, trajectory.points.back().stamp_ns);
}

/// A refined truth turns and accelerates as its IMU measured; a coarser spline would smooth that away.
double KnotSpacing(const Trajectory& samples, const SimulatorConfig& config) {
  return samples.has_covariance ? DurationOf(samples) / static_cast<double>(samples.points.size() - 1)
                                : config.knot_spacing_s;
}

Status In(const std::string& path, const Status& status) {
  return {status.code(), path + ": " + status.message()};
}

}  // namespace

Result<std::string> FindTruth(const std::string& source, const std::string& truth_file) {
  if (MayExist(source) && !MayBeFolder(source)) {
    return source;
  }
  if (!MayExist(source)) {
    return Status::Input(source + ": no such file, expected a trajectory or a dataset folder");
  }
  const fs::path folder = fs::path(source) / "mav0" / "state_groundtruth_estimate0";
  if (truth_file != "auto") {
    const fs::path path = folder / truth_file;
    return MayExist(path.string())
               ? Result<std::string>(path.string())
               : Status::Input(path.string() + ": no such file, expected the one that truth_file names");
  }
  for (const char* name : {"data_recomputed.csv", "data.csv", "data_pose.csv"}) {
    if (MayExist((folder / name).string())) {
      return (folder / name).string();
    }
  }
  return Status::Input(folder.string() +
                       ": expected data_recomputed.csv, data.csv or data_pose.csv; found none");
}

Result<Trajectory> KeepGapFree(const Trajectory& recorded, double max_gap_s, TruthGaps policy) {
  const std::vector<TrajectoryPoint>& points = recorded.points;
  std::size_t best_first = 0;
  std::size_t best_last = 0;
  std::size_t first = 0;
  int gaps = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k > 0 && SecondsBetween(points[k - 1].stamp_ns, points[k].stamp_ns) > max_gap_s) {
      ++gaps;
      first = k;
    }
    if (points[k].stamp_ns - points[first].stamp_ns >
        points[best_last].stamp_ns - points[best_first].stamp_ns) {
      best_first = first;
      best_last = k;
    }
  }
  if (gaps > 0 && policy == TruthGaps::kRefuse) {
    return Status::Input(std::to_string(gaps) + " gaps longer than max_gap_s " + Format("%g", max_gap_s) +
                         " s; expected none, a larger max_gap_s or truth_gaps: longest_span");
  }
  Trajectory kept = recorded;
  kept.points.assign(points.begin() + static_cast<std::ptrdiff_t>(best_first),
                     points.begin() + static_cast<std::ptrdiff_t>(best_last) + 1);
  return kept;
}

Result<RecordedMotion> LoadRecordedMotion(const std::string& source, const SimulatorConfig& config) {
  const Result<std::string> path = FindTruth(source, config.truth_file);
  ALIDADE_RETURN_IF_ERROR(path.status());
  const Result<Trajectory> recorded = ReadTrajectory(*path);
  ALIDADE_RETURN_IF_ERROR(recorded.status());
  Result<Trajectory> samples = KeepGapFree(*recorded, config.max_gap_s, config.truth_gaps);
  if (!samples.ok()) {
    return In(*path, samples.status());
  }
  while (DurationOf(*samples) > config.duration_s) {
    samples->points.pop_back();
  }
  if (DurationOf(*samples) < kMinDurationSeconds) {
    return Status::Input(*path + ": " + Format("%g", DurationOf(*samples)) +
                         " s without a gap longer than max_gap_s " + Format("%g", config.max_gap_s) +
                         " s; expected a second or more");
  }
  const Result<SplineTrajectory> motion = SplineTrajectory::Fit(*samples, KnotSpacing(*samples, config));
  if (!motion.ok()) {
    return In(*path, motion.status());
  }
  return RecordedMotion{*path, std::move(samples).value(), *motion};
}

}  // namespace alidade
