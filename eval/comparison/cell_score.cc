#include "eval/comparison/cell_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <unordered_map>

#include "core/error_convention.h"
#include "core/format.h"
#include "core/numbers.h"
#include "eval/comparison/series_rows.h"
#include "eval/comparison/sky_tracks.h"
#include "eval/metrics/nees.h"
#include "eval/metrics/silent_failure.h"
#include "eval/metrics/trajectory_alignment.h"

namespace alidade {
namespace {

/// Longer without a measurement of a sensor is an outage.
constexpr double kSilenceS = 2;
/// Regular points of a curve beyond these are not seen on a screen.
constexpr size_t kMaxSeriesPoints = 600;

/// The value, unless it is NaN.
std::optional<double> Known(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

std::optional<double> Mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) {
    sum += value;
  }
  return values.empty() ? std::nullopt : std::optional(sum / static_cast<double>(values.size()));
}

/// Nearest-rank percentile.
std::optional<double> Percentile(std::vector<double> values, double share) {
  if (values.empty()) {
    return std::nullopt;
  }
  const size_t rank = static_cast<size_t>(std::ceil(share * static_cast<double>(values.size())));
  const size_t index = std::min(values.size() - 1, rank == 0 ? 0 : rank - 1);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

void FillFigures(const Evaluation& evaluation, CellResult* cell) {
  cell->duration_s = evaluation.duration_s;
  cell->path_m = evaluation.path_m;
  cell->rmse_pos_m = Known(evaluation.unaligned.pos_m);
  cell->rmse_ori_deg = Known(evaluation.unaligned.ori_deg);
  cell->ate_pos_m = Known(evaluation.ate.pos_m);
  cell->ate_ori_deg = Known(evaluation.ate.ori_deg);
  cell->rpe = evaluation.rpe;
  if (evaluation.nees) {
    cell->nees_pose = evaluation.nees->mean_pose;
    cell->nees_ori = evaluation.nees->mean_orientation;
    cell->nees_pos = evaluation.nees->mean_position;
    cell->coverage_3sigma = evaluation.nees->coverage_3sigma;
    cell->nees_vel = Known(evaluation.nees->mean_velocity);
    cell->nees_gyro_bias = Known(evaluation.nees->mean_gyro_bias);
    cell->nees_accel_bias = Known(evaluation.nees->mean_accel_bias);
    cell->truth_has_covariance = evaluation.truth_has_covariance;
  }
}

/// One row a pair.
CellSeries MakeSeries(const Evaluation& evaluation) {
  CellSeries series;
  const std::vector<StatePair> aligned = ApplyAlignment(evaluation.pairs, evaluation.transform);
  for (size_t i = 0; i < evaluation.pairs.size(); ++i) {
    const StatePair& pair = evaluation.pairs[i];
    series.time_s.push_back(
        SecondsBetween(evaluation.pairs.front().estimate.stamp_ns, pair.estimate.stamp_ns));
    series.truth_position.push_back(pair.truth.nav.p_WB);
    series.position.push_back(aligned[i].estimate.nav.p_WB);
    series.error.push_back(Local(ErrorConvention::kSo3xRn, pair.estimate.nav.T_WB(), pair.truth.nav.T_WB()));
    const Matrix6d covariance = evaluation.nees ? ErrorCovariance(pair) : pair.estimate.covariance;
    series.sigma.push_back(covariance.diagonal().cwiseMax(0).cwiseSqrt());
    series.nees_pose.push_back(evaluation.nees ? evaluation.nees->pose[i] : kNan);
  }
  return series;
}

/// A sensor's innovations in a frame's statistics.
struct Innovations {
  double nis = 0;
  int dof = 0;

  [[nodiscard]] double Ratio() const { return dof > 0 ? nis / dof : kNan; }
};

Innovations InnovationsOf(Sensor sensor, const FrameStatistics& frame) {
  if (sensor == Sensor::kCamera) {
    return {frame.nis, frame.nis_dof};
  }
  if (sensor == Sensor::kGnss) {
    return {frame.gnss_nis, frame.gnss_nis_dof};
  }
  return {frame.sensors[sensor].nis, frame.sensors[sensor].nis_dof};
}

/// GNSS, and those of SensorEntries.
std::vector<Sensor> SensorsBetweenFrames() {
  std::vector<Sensor> sensors = {Sensor::kGnss};
  ForEachSensorEntry([&](auto, Sensor sensor) { sensors.push_back(sensor); });
  return sensors;
}

/// Stamp of a pair in the run itself.
TimeNs RunStamp(const Evaluation& evaluation, const StatePair& pair) {
  return pair.estimate.stamp_ns - SecondsToNs(evaluation.options.association.time_offset_s);
}

/// What the frames of the pairs did to the estimator, and what an audit recorded.
void FillRunSeries(const Evaluation& evaluation, const RunResult& run, CellSeries* series) {
  const bool audited = std::any_of(run.records.begin(), run.records.end(),
                                   [](const RunRecord& record) { return record.observability.has_value(); });
  std::unordered_map<TimeNs, const RunRecord*> by_stamp;
  for (const RunRecord& record : run.records) {
    by_stamp[record.estimate.stamp_ns] = &record;
  }
  for (const StatePair& pair : evaluation.pairs) {
    const auto record = by_stamp.find(RunStamp(evaluation, pair));
    const bool found = record != by_stamp.end();
    series->backend_ms.push_back(found ? record->second->backend_ms : kNan);
    series->features_used.push_back(found ? record->second->statistics.features_used : kNan);
    series->tracks_in.push_back(found ? record->second->statistics.tracks_in : kNan);
    series->nis_ratio.push_back(found ? InnovationsOf(Sensor::kCamera, record->second->statistics).Ratio()
                                      : kNan);
    if (audited) {
      const bool has = found && record->second->observability.has_value();
      series->rank.push_back(has ? record->second->observability->rank : kNan);
      series->yaw_leak.push_back(has ? record->second->observability->yaw_leak : kNan);
      series->position_leak.push_back(has ? record->second->observability->position_leak : kNan);
    }
  }
}

/// Whether the run told its errors.
void FillSilentFailure(const Evaluation& evaluation, const RunResult& run, CellResult* cell) {
  if (!evaluation.nees) {
    return;
  }
  std::unordered_map<TimeNs, bool> alarmed;
  for (const RunRecord& record : run.records) {
    alarmed[record.estimate.stamp_ns] = IsAlarm(record.status);
  }
  std::vector<ReportedError> instants;
  for (size_t i = 0; i < evaluation.pairs.size(); ++i) {
    const TimeNs stamp_ns = RunStamp(evaluation, evaluation.pairs[i]);
    instants.push_back({stamp_ns, evaluation.nees->pose[i], alarmed[stamp_ns]});
  }
  const SilentFailure failure = ComputeSilentFailure(instants);
  cell->silent_s = failure.silent_s;
  cell->alarm_inside_share = Known(failure.alarm_inside_share);
}

/// The newest GNSS innovations of each pair: GNSS is slower than the camera, and what is thinned would miss
/// them.
void FillInnovations(Sensor sensor, const Evaluation& evaluation, const RunResult& run, CellSeries* series) {
  std::vector<double> ratios;
  double newest = kNan;
  TimeNs newest_ns = 0;
  auto record = run.records.begin();
  for (const StatePair& pair : evaluation.pairs) {
    const TimeNs stamp_ns = RunStamp(evaluation, pair);
    for (; record != run.records.end() && record->estimate.stamp_ns <= stamp_ns; ++record) {
      const Innovations innovations = InnovationsOf(sensor, record->statistics);
      if (innovations.dof > 0) {
        newest = innovations.Ratio();
        newest_ns = record->estimate.stamp_ns;
      }
    }
    ratios.push_back(SecondsBetween(newest_ns, stamp_ns) <= kSilenceS ? newest : kNan);
  }
  if (!std::isnan(newest)) {
    series->sensor_nis_ratio.emplace(ToString(sensor), std::move(ratios));
  }
}

InnovationSummary Summarize(Sensor sensor, const std::vector<RunRecord>& records) {
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

/// Root mean squares of predicted deviations.
void FillPredicted(const RunResult& run, CellResult* cell) {
  double ori = 0, pos = 0, filtering_ori = 0, filtering_pos = 0;
  for (const RunRecord& record : run.records) {
    ori += record.estimate.covariance.diagonal().head<3>().sum();
    pos += record.estimate.covariance.diagonal().segment<3>(3).sum();
    const Matrix6d filtering = record.filtering_covariance.value_or(Matrix6d::Constant(kNan));
    filtering_ori += filtering.diagonal().head<3>().sum();
    filtering_pos += filtering.diagonal().tail<3>().sum();
  }
  const double count = static_cast<double>(run.records.size());
  cell->sigma_ori_deg = Known(kDegreesPerRadian * std::sqrt(ori / count));
  cell->sigma_pos_m = Known(std::sqrt(pos / count));
  cell->filtering_sigma_ori_deg = Known(kDegreesPerRadian * std::sqrt(filtering_ori / count));
  cell->filtering_sigma_pos_m = Known(std::sqrt(filtering_pos / count));
}

void Score(const Trajectory* truth, const Trajectory& estimate, const RunResult* run,
           const EvaluationOptions& options, CellResult* cell) {
  cell->align = std::string(ToString(options.alignment)) +
                (options.align_share < 1 ? Format(" of the first %g %%", 100 * options.align_share) : "");
  cell->frames = static_cast<int>(estimate.points.size());
  if (estimate.points.empty()) {
    return;
  }
  if (truth == nullptr) {
    cell->message += (cell->message.empty() ? "" : "; ") + std::string("no ground truth to score against");
    return;
  }
  const Result<Evaluation> evaluation = Evaluate(*truth, estimate, options);
  if (!evaluation.ok()) {
    cell->message += (cell->message.empty() ? "" : "; ") + evaluation.message();
    cell->status = cell->status == "ok" ? "failed" : cell->status;
    return;
  }
  FillFigures(*evaluation, cell);
  CellSeries series = MakeSeries(*evaluation);
  if (run != nullptr) {
    FillRunSeries(*evaluation, *run, &series);
    for (const Sensor sensor : SensorsBetweenFrames()) {
      FillInnovations(sensor, *evaluation, *run, &series);
    }
    FillSilentFailure(*evaluation, *run, cell);
  }
  cell->series = TakeRows(series, PickRows(series, kMaxSeriesPoints));
}

}  // namespace

void ScoreTrajectory(const Trajectory* truth, const Trajectory& estimate, const EvaluationOptions& options,
                     CellResult* cell) {
  cell->status = "ok";
  Score(truth, estimate, nullptr, options, cell);
}

void ScoreTimes(const std::vector<double>& frontend_ms, const std::vector<double>& backend_ms,
                CellResult* cell) {
  cell->frontend_ms = Mean(frontend_ms);
  if (cell->frontend_ms == 0.0) {
    cell->frontend_ms.reset();
  }
  cell->backend_ms = Mean(backend_ms);
  cell->backend_ms_p95 = Percentile(backend_ms, 0.95);
}

void ScoreRun(const Trajectory* truth, const RunResult& run, const EvaluationOptions& options,
              CellResult* cell) {
  cell->status = StatusWord(run);
  cell->message = run.status.message();
  std::vector<double> frontend_ms, backend_ms, propagate_ms, update_ms, features;
  double used = 0, gated = 0;
  for (const RunRecord& record : run.records) {
    frontend_ms.push_back(record.frontend_ms);
    backend_ms.push_back(record.backend_ms);
    propagate_ms.push_back(record.statistics.propagate_ms);
    update_ms.push_back(record.statistics.update_ms);
    features.push_back(record.statistics.features_used);
    used += record.statistics.features_used;
    gated += record.statistics.features_gated;
  }
  ScoreTimes(frontend_ms, backend_ms, cell);
  cell->propagate_ms = Mean(propagate_ms);
  cell->update_ms = Mean(update_ms);
  cell->innovations = Summarize(Sensor::kCamera, run.records);
  for (const Sensor sensor : SensorsBetweenFrames()) {
    const InnovationSummary summary = Summarize(sensor, run.records);
    if (summary.ratio) {
      cell->sensor_innovations.emplace(ToString(sensor), summary);
    }
  }
  cell->features_per_frame = Mean(features);
  if (used + gated > 0) {
    cell->gated_share = gated / (used + gated);
  }
  cell->restarts = static_cast<int>(run.restarts.size());
  if (run.calibration_error) {
    cell->calibration_rotation_deg = run.calibration_error->rotation_rad * 180 / std::numbers::pi;
    cell->calibration_translation_m = run.calibration_error->translation_m;
    cell->calibration_time_ms = 1e3 * run.calibration_error->time_offset_s;
  }
  FillPredicted(run, cell);
  constexpr size_t kSkyPoints = 24;
  cell->sky = MakeSkyTracks(run.gnss_residuals, kSkyPoints);
  Score(truth, TrajectoryOf(run), &run, options, cell);
}

}  // namespace alidade
