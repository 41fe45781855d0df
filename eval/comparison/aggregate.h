#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "eval/comparison/cell_group.h"
#include "eval/comparison/comparison.h"
#include "eval/comparison/figure.h"

namespace alidade {

/// Mean over the seeds that have the value; NaN when none has.
struct Statistic {
  int count = 0;
  double mean = 0;
  double standard_error = 0;  ///< of the mean, from the sample deviation; NaN with fewer than two values
  double largest = std::numeric_limits<double>::quiet_NaN();
};
[[nodiscard]] Statistic ComputeStatistic(const std::vector<double>& values);

/// One estimator on one sequence, over its seeds. Only cells with status ok enter the means, but those
/// of a figure of all runs (Figure::of_all_runs): every mean must be read together with `ok` of `cells`.
struct AggregateRow {
  std::string estimator;
  std::string backend;
  bool smoothed = false;
  std::string label;  ///< the estimator's name, with its back end where two back ends share the name
  std::string sequence;
  std::string group;  ///< of the sequence; may be empty
  int cells = 0, ok = 0, diverged = 0, not_initialized = 0, failed = 0;
  std::vector<Statistic> figures;  ///< parallel to ListFigures
  std::vector<bool> best;          ///< parallel to ListFigures: best of this sequence
  /// 95 % bands of the mean NEES over `ok` runs, a run counted as ONE sample: errors of neighbouring frames
  /// are strongly correlated, so this band is the widest that the chi-square assumption allows. NaN when ok
  /// is 0.
  std::pair<double, double> nees_pose_band, nees_ori_band, nees_pos_band;
  /// Share of the instants at which the pose NEES averaged over the runs lies in its own 95 % band
  /// (eval/comparison/nees_over_time.h): the sharper test. NaN without covariance.
  double nees_inside_share = std::numeric_limits<double>::quiet_NaN();
  std::string nees_verdict;  ///< of the mean pose NEES against its band; empty without covariance
  /// Mean RMSE over that of the same estimator on Comparison::baseline; NaN without a baseline or a value.
  double rmse_pos_ratio = std::numeric_limits<double>::quiet_NaN();
  double rmse_ori_ratio = std::numeric_limits<double>::quiet_NaN();
  /// Mean RMSE over the lowest one of the sequence, among the estimators that can be best; NaN without a
  /// value.
  double rmse_pos_to_best = std::numeric_limits<double>::quiet_NaN();
  double rmse_ori_to_best = std::numeric_limits<double>::quiet_NaN();
};

/// Rows by sequence, then estimator, both in order of first appearance. `best` is marked among the rows of a
/// sequence with the most runs that are ok (of a figure of all runs: among all), and only where at least two
/// of them have the value; equal values are all marked. A smoothed estimate uses later data than the others
/// and is never marked.
[[nodiscard]] std::vector<AggregateRow> Aggregate(const Comparison& comparison,
                                                  const std::vector<Figure>& figures);

/// Sequences and row labels in order of first appearance.
[[nodiscard]] std::vector<std::string> ListSequences(const std::vector<AggregateRow>& rows);
[[nodiscard]] std::vector<std::string> ListLabels(const std::vector<AggregateRow>& rows);

}  // namespace alidade
