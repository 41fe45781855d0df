#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/status.h"
#include "eval/bag/dataset_source.h"
#include "eval/compare/external_run.h"
#include "eval/comparison/comparison.h"
#include "eval/metrics/evaluate.h"

namespace alidade {

/// One row of a comparison: a configured estimator, trajectories of another program, or a command that runs
/// one.
struct PlanEstimator {
  std::string name;
  std::string config;                               ///< path; empty for an external one
  std::vector<std::string> settings;                ///< "a.b=value" over the file
  std::map<std::string, std::string> trajectories;  ///< sequence name -> path; external only
  ExternalCommand command;                          ///< empty text: none; external only
  bool camera_frame = false;                        ///< the external poses are the camera's, not the body's
  bool smoothed = false;               ///< external only: a row may use data of later than its stamp
  std::vector<std::string> sequences;  ///< only these; empty: all
  std::optional<TrajectoryAlignment> alignment;  ///< its own instead of the plan's
  std::optional<double> align_share;

  [[nodiscard]] bool external() const { return config.empty(); }
  [[nodiscard]] bool RunsOn(const std::string& sequence) const;
};

/// One input of a comparison: a dataset (a folder or a bag) or a simulation, once a seed.
struct PlanSequence {
  std::string name;
  std::string group;      ///< heading in the maps of the report; may be empty
  DatasetSource dataset;  ///< `path` is empty for a simulation
  std::string truth;      ///< trajectory file to score against instead of the dataset's own; may be empty
  std::string config;     ///< simulation config; empty for a dataset
  std::vector<std::string> settings;            ///< over the simulation config
  std::vector<std::string> estimator_settings;  ///< over every estimator's own, on this sequence alone
  std::optional<bool> anchor_at_first;          ///< its own instead of the plan's
  std::vector<unsigned> seeds = {1};  ///< of the simulation, and of the prior that init.method truth draws
};

/// The content of a plan (docs/plans.md lists the keys).
struct Plan {
  std::string path;
  std::string title;
  std::vector<std::string> settings;  ///< over every estimator's file, before the estimator's own
  std::vector<PlanEstimator> estimators;
  std::vector<PlanSequence> sequences;
  EvaluationOptions metrics;        ///< but for what MetricsOf sets
  std::optional<bool> interpolate;  ///< the truth; by default where it is a simulation's own
  std::vector<std::string> pair_figures = Comparison().pair_figures;
  bool pair_across = false;
  std::string baseline;  ///< name of the sequence that RMSEs are also given relative to; may be empty
  bool audit = false;    ///< every filter writes its observability audit
  std::vector<ReferenceFigure> references;
  /// skip_missing: a sequence whose folder is missing is skipped and listed in `absent` (name, path).
  bool skip_missing = false;
  std::vector<std::pair<std::string, std::string>> absent;
  /// Estimators whose `program` is missing (name, path): they are listed as not run.
  std::vector<std::pair<std::string, std::string>> absent_programs;

  [[nodiscard]] EvaluationOptions MetricsOf(const PlanEstimator& estimator,
                                            const PlanSequence& sequence) const;
};

}  // namespace alidade
