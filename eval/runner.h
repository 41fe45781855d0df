#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/estimator.h"
#include "core/measurement_log.h"
#include "eval/trajectory.h"

namespace alidade {

/// One processed frame of a run.
struct RunRecord {
  NavEstimate estimate;
  FrameStatistics statistics;
  double frontend_ms = 0;
  double backend_ms = 0;
  std::string status = "ok";
};

struct RunResult {
  Status status;                    ///< kDiverged when never initialised or lost; records hold what there was
  std::vector<RunRecord> records;   ///< one a frame since initialisation
  std::string init_method;          ///< truth | static | dynamic
  std::string init_report;          ///< what the initialiser found, or why it did not initialise
  TimeNs init_stamp_ns = 0;
  int frames_skipped = 0;
  double wall_s = 0;
  double cpu_s = 0;
};

/// The back end that `config.backend` names.
[[nodiscard]] std::unique_ptr<Estimator> MakeEstimator(const EstimatorConfig& config, const RigCalibration& rig);

/// Feeds the log to one estimator in time order. `truth` is read only by init.method truth; `seed` draws its prior.
[[nodiscard]] RunResult RunEstimator(const EstimatorConfig& config, const MeasurementLog& log, const Trajectory* truth,
                                     unsigned seed);

}  // namespace alidade
