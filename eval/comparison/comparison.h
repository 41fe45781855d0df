#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "eval/files/machine.h"
#include "eval/frontend_run/frontend_summary.h"
#include "eval/metrics/metrics.h"

namespace alidade {

/// Time series of one cell, thinned for plotting (eval/comparison/series_rows.h); all vectors have one entry
/// a kept frame, or none at all.
struct CellSeries {
  std::vector<bool> regular;   ///< evenly spaced rows, the only ones used in means; empty: all
  std::vector<double> time_s;  ///< since the first pair
  std::vector<Eigen::Vector3d> truth_position;
  std::vector<Eigen::Vector3d> position;  ///< aligned as in the plan
  std::vector<Vector6d> error;            ///< (phi [rad], dp [m]) unaligned, canonical chart
  std::vector<Vector6d> sigma;            ///< standard deviations of the same
  std::vector<double> nees_pose;
  std::vector<double> backend_ms;
  std::vector<double> features_used;
  std::vector<double> tracks_in;  ///< passed to the estimator with the frame
  std::vector<double> nis_ratio;  ///< normalised innovation squared over its rows; NaN without rows
  /// By the key of a sensor between frames (ToString in core/estimator/measurement.h): of its newest
  /// measurement; NaN in outages. Sensors without measurements are left out.
  std::map<std::string, std::vector<double>> sensor_nis_ratio;
  // Of an audited filter, else empty (eval/audit/observability.h).
  std::vector<double> rank;
  std::vector<double> yaw_leak;       ///< [1/rad^2]
  std::vector<double> position_leak;  ///< [1/m^2]
};

/// Consistency of a run's innovations with their covariance; for a smoother, of the residuals of its window
/// after the solve.
struct InnovationSummary {
  std::optional<double> ratio;   ///< sum of the NIS over the sum of their rows
  std::optional<double> inside;  ///< share of frames in the 95 % chi-square band
  /// That band over its rows, of a frame with the median number of rows.
  std::optional<std::pair<double, double>> band;
};

/// Directions and residuals of a GNSS satellite in a run (eval/comparison/sky_tracks.h).
struct SkyTrack {
  std::string satellite;
  std::vector<double> time_s, azimuth_deg, elevation_deg;
  std::vector<double> residual_m;  ///< predicted - measured pseudorange
  double used_share = 0;           ///< of the epochs in which it was received
  double rms_m = 0;                ///< of the used residuals
};

/// One row of summary.csv: one estimator on one sequence with one seed. A figure without a value is unknown:
/// the run failed, there is no ground truth, or an external trajectory has no covariance or times.
struct CellResult {
  std::string estimator;
  std::string backend;
  /// Each row may use all data of the sequence, as the batch estimate does; else only those until its stamp.
  bool smoothed = false;
  std::string sequence;
  unsigned seed = 0;
  std::string status;  ///< ok | diverged | not_initialized | failed: reason in `message`
  std::string message;
  std::string input_digest;
  int frames = 0;
  std::optional<double> duration_s;
  /// Share of the camera's time with an estimate (eval/metrics/completion.h), however the run ended.
  std::optional<double> completion;
  std::optional<double> path_m;
  std::optional<double> rmse_pos_m, rmse_ori_deg;  ///< unaligned
  std::optional<double> ate_pos_m, ate_ori_deg;
  std::string align;
  std::vector<RpeResult> rpe;
  std::optional<double> nees_pose, nees_ori, nees_pos, coverage_3sigma;
  std::optional<double> nees_vel, nees_gyro_bias, nees_accel_bias;  ///< where the truth holds them
  bool truth_has_covariance = false;  ///< which the first four NEES figures then include
  std::optional<double> frontend_ms;  ///< also unknown where the tracks were read from a file
  std::optional<double> backend_ms, backend_ms_p95;
  /// Seconds of camera data processed per second of front end and back end; where the tracks were read from a
  /// file, of the back end alone.
  std::optional<double> realtime_factor;
  std::optional<double> features_per_frame;
  /// Stages of backend_ms, means a frame; other back-end time belongs to neither.
  std::optional<double> propagate_ms, update_ms;
  InnovationSummary innovations;
  std::map<std::string, InnovationSummary> sensor_innovations;  ///< as CellSeries::sensor_nis_ratio
  /// Share of tracks rejected by the chi-square gate; unknown when no track reached it. On data without
  /// outliers these are false rejections.
  std::optional<double> gated_share;
  /// Of a run with status and covariance (eval/metrics/silent_failure.h): seconds with an error beyond 5 of
  /// its own sigma while the status was ok, and share of the frames with an alarm although the error was
  /// within 3.
  std::optional<double> silent_s, alarm_inside_share;
  /// Root mean square of the deviations that the run's own covariance predicts: square root of the mean trace
  /// of the covariance of phi and of dp.
  std::optional<double> sigma_pos_m, sigma_ori_deg;
  /// The same given the data up to each frame alone; of the batch estimate.
  std::optional<double> filtering_sigma_pos_m, filtering_sigma_ori_deg;
  /// How far the last online calibration is from the truth.
  std::optional<double> calibration_rotation_deg, calibration_translation_m, calibration_time_ms;
  int restarts = 0;   ///< times the estimate was lost
  bool shown = true;  ///< by itself in reports; of a large comparison (large_comparison.h) not all are
  CellSeries series;
  std::vector<SkyTrack> sky;  ///< empty without GNSS
};

/// "causal" or "smoothed", as in plans.
[[nodiscard]] std::string ModeWord(bool smoothed);

/// A published figure to print beside the measured ones.
struct ReferenceFigure {
  std::string source;  ///< "the paper", ...
  std::string estimator;
  std::string sequence;
  std::map<std::string, double> figures;  ///< column of summary.csv -> value
};

/// What made a comparison's tables.
struct Provenance {
  std::string version;  ///< of Alidade; empty: not recorded
  std::string date;     ///< in UTC
  Machine machine;      ///< that wrote the tables; cells of a cluster may have run on others
};

struct Comparison {
  /// Names of the sequences whose truth has a covariance, which their NEES include; sorted.
  [[nodiscard]] std::vector<std::string> SequencesWithTruthCovariance() const;
  /// Names of the estimators that are smoothed, in order of first appearance.
  [[nodiscard]] std::vector<std::string> SmoothedEstimators() const;

  std::string title;
  std::vector<CellResult> cells;
  std::vector<ReferenceFigure> references;
  Provenance provenance = {};
  std::string command;                  ///< command line that repeats it
  std::vector<std::string> notes = {};  ///< printed with the tables, such as sequences that were not run
  std::string shown_note = {};          ///< of a large one: of which cells it has curves
  /// Figures whose paired differences the tables show; pairs.csv has all of them.
  std::vector<std::string> pair_figures = {"rmse_ori_deg", "rmse_pos_m"};
  bool pair_across = false;  ///< show them over the sequences, one sample a sequence, not within each
  /// Of each sequence and seed whose images were tracked.
  std::vector<FrontendSummary> frontends = {};
  std::string baseline;  ///< sequence that RMSEs are also given relative to; may be empty
  std::map<std::string, std::string> groups = {};  ///< of the sequences that have one
};

}  // namespace alidade
