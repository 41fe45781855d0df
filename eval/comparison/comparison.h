#pragma once

#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "eval/frontend_run/frontend_summary.h"
#include "eval/metrics/metrics.h"
#include "eval/record/runner.h"

namespace alidade {

/// Time series of one cell, thinned for plotting (eval/comparison/series_rows.h); all vectors have one entry
/// a kept frame, or none at all.
struct CellSeries {
  std::vector<bool> regular;   ///< picked at even steps: these alone may enter means; empty: all of them
  std::vector<double> time_s;  ///< since the first pair
  std::vector<Eigen::Vector3d> truth_position;
  std::vector<Eigen::Vector3d> position;  ///< aligned as the plan says
  std::vector<Vector6d> error;            ///< (phi [rad], dp [m]) unaligned, canonical chart
  std::vector<Vector6d> sigma;            ///< standard deviations of the same
  std::vector<double> nees_pose;
  std::vector<double> backend_ms;
  std::vector<double> features_used;
  std::vector<double> tracks_in;       ///< that the frame handed to the estimator
  std::vector<double> nis_ratio;       ///< normalised innovation squared over its rows; NaN without rows
  std::vector<double> gnss_nis_ratio;  ///< of the newest epoch; NaN in outages, empty without GNSS
  // Of an audited filter, else empty (eval/audit/observability.h).
  std::vector<double> rank;
  std::vector<double> yaw_leak;       ///< [1/rad^2]
  std::vector<double> position_leak;  ///< [1/m^2]
};

/// How well the innovations of a run fit their own covariance. A smoother tells what is left of its window's
/// residuals after the fit. NaN when not known.
struct InnovationSummary {
  double ratio = std::numeric_limits<double>::quiet_NaN();   ///< sum of the NIS over the sum of their rows
  double inside = std::numeric_limits<double>::quiet_NaN();  ///< share of frames in the 95 % chi-square band
  /// That band over its rows, of a frame with the median number of rows.
  std::pair<double, double> band{std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::quiet_NaN()};
};

/// How a GNSS satellite stood and fitted in a run (eval/comparison/sky_tracks.h).
struct SkyTrack {
  std::string satellite;
  std::vector<double> time_s, azimuth_deg, elevation_deg;
  std::vector<double> residual_m;  ///< predicted - measured pseudorange
  double used_share = 0;           ///< of the epochs it was seen in
  double rms_m = 0;                ///< of the used residuals
};

/// One row of summary.csv: one estimator on one sequence with one seed.
struct CellResult {
  std::string estimator;
  std::string backend;
  std::string sequence;
  unsigned seed = 0;
  std::string status;  ///< ok | diverged | not_initialized | failed: reason in `message`
  std::string message;
  std::string input_digest;
  int frames = 0;
  double duration_s = 0;
  double path_m = 0;
  double rmse_pos_m = 0, rmse_ori_deg = 0;  ///< unaligned
  double ate_pos_m = 0, ate_ori_deg = 0;
  std::string align;
  std::vector<RpeResult> rpe;
  double nees_pose = 0, nees_ori = 0, nees_pos = 0, coverage_3sigma = 0;
  double frontend_ms = 0, backend_ms = 0, backend_ms_p95 = 0;
  double features_per_frame = 0;
  /// Stages of backend_ms, means a frame; the rest is neither. NaN when not known.
  double propagate_ms = std::numeric_limits<double>::quiet_NaN();
  double update_ms = std::numeric_limits<double>::quiet_NaN();
  InnovationSummary innovations;
  InnovationSummary gnss_innovations;
  /// Of the tracks that met the chi-square gate, those it refused; NaN when none did. On data without
  /// outliers these are false rejections.
  double gated_share = std::numeric_limits<double>::quiet_NaN();
  /// Root mean square of the deviations that the run's own covariance predicts: square root of the mean trace
  /// of the covariance of phi and of dp. NaN without covariance.
  double sigma_pos_m = std::numeric_limits<double>::quiet_NaN();
  double sigma_ori_deg = std::numeric_limits<double>::quiet_NaN();
  /// The same given the data up to each frame alone; of an estimator that looks back and knows it.
  double filtering_sigma_pos_m = std::numeric_limits<double>::quiet_NaN();
  double filtering_sigma_ori_deg = std::numeric_limits<double>::quiet_NaN();
  /// How far the last online calibration is from the truth; NaN when either is missing.
  double calibration_rotation_deg = std::numeric_limits<double>::quiet_NaN();
  double calibration_translation_m = std::numeric_limits<double>::quiet_NaN();
  double calibration_time_ms = std::numeric_limits<double>::quiet_NaN();
  int restarts = 0;  ///< times the estimate was lost
  CellSeries series;
  std::vector<SkyTrack> sky;  ///< empty without GNSS
};

/// A published figure to print beside the measured ones.
struct ReferenceFigure {
  std::string source;  ///< "the paper", ...
  std::string estimator;
  std::string sequence;
  std::map<std::string, double> figures;  ///< column of summary.csv -> value
};

struct Comparison {
  std::string title;
  std::vector<CellResult> cells;
  std::vector<ReferenceFigure> references;
  std::string command;                  ///< how to repeat it
  std::vector<std::string> notes = {};  ///< said with the tables, such as what was not run
  /// Figures whose paired differences the tables show; pairs.csv has all of them.
  std::vector<std::string> pair_figures = {"rmse_ori_deg", "rmse_pos_m"};
  bool pair_across = false;  ///< show them over the sequences, one sample a sequence, not within each
  /// Of each sequence and seed whose tracks the front end made here.
  std::vector<FrontendSummary> frontends = {};
  std::string baseline;  ///< sequence that RMSEs are also given relative to; may be empty
};

/// Writes summary.csv, aggregate.csv, pairs.csv, nees_over_time.csv, tables.md, tables.tex and report.json
/// into `folder` (docs/plans.md).
Status WriteTables(const Comparison& comparison, const std::string& folder);

/// Writes the page that people look at (docs/report.md): one self-contained offline file.
Status WriteReport(const Comparison& comparison, const std::string& path);

/// The table that a person reads on the terminal.
[[nodiscard]] std::string FormatTable(const Comparison& comparison);

}  // namespace alidade
