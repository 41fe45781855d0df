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
#include "eval/comparison/innovations.h"
#include "eval/comparison/series_rows.h"
#include "eval/comparison/sky_tracks.h"
#include "eval/metrics/error_statistics.h"
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

/// What the frames of the pairs did to the estimator, and what an audit recorded.
void FillRunSeries(const Evaluation& evaluation, const RunResult& run, CellSeries* series) {
  const bool audited = std::any_of(run.records.begin(), run.records.end(),
                                   [](const RunRecord& record) { return record.observability.has_value(); });
  std::unordered_map<TimeNs, const RunRecord*> by_stamp;
  for (const RunRecord& record : run.records) {
    by_stamp[record.estimate.stamp_ns] = &record;
  }
  for (const StatePair& pair : evaluation.pairs) {
    const auto record = by_stamp.find(evaluation.EstimateStamp(pair));
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

/// How long errors were large while the status was ok.
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
    const TimeNs stamp_ns = evaluation.EstimateStamp(evaluation.pairs[i]);
    instants.push_back({stamp_ns, evaluation.nees->pose[i], alarmed[stamp_ns]});
  }
  const SilentFailure failure = ComputeSilentFailure(instants);
  cell->silent_s = failure.silent_s;
  cell->alarm_inside_share = Known(failure.alarm_inside_share);
}

/// The newest innovations of a sensor at each pair: a sensor slower than the camera would be lost when rows
/// are thinned.
void FillInnovations(Sensor sensor, const Evaluation& evaluation, const RunResult& run, CellSeries* series) {
  std::vector<double> ratios;
  double newest = kNan;
  TimeNs newest_ns = 0;
  auto record = run.records.begin();
  for (const StatePair& pair : evaluation.pairs) {
    const TimeNs stamp_ns = evaluation.EstimateStamp(pair);
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

void AddMessage(const std::string& text, CellResult* cell) {
  cell->message += (cell->message.empty() || text.empty() ? "" : "; ") + text;
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
    AddMessage("no ground truth to score against", cell);
    return;
  }
  const Result<Evaluation> evaluation = Evaluate(*truth, estimate, options);
  if (!evaluation.ok()) {
    AddMessage(evaluation.message(), cell);
    cell->status = cell->status == "ok" ? "failed" : cell->status;
    return;
  }
  AddMessage(RemarkOnWorld(*evaluation), cell);
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
  cell->innovations = SummarizeInnovations(Sensor::kCamera, run.records);
  for (const Sensor sensor : SensorsBetweenFrames()) {
    const InnovationSummary summary = SummarizeInnovations(sensor, run.records);
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
