#pragma once

#include "eval/run/runner.h"
#include "frontend/initialization/initializer.h"

namespace alidade {

/// Finds the first state of a run with a camera, by init.method: drawn around the truth, or from the data.
class RunStart {
 public:
  /// All arguments must outlive it. `result` gets init_method and init_report.
  RunStart(const EstimatorConfig& config, const MeasurementLog& log, const RunOptions& options,
           RunResult* result);

  void AddImu(const ImuSample& sample) { initializer_.AddImu(sample); }
  /// The state at a frame of this IMU time, or why there is none yet; where there can be none at all,
  /// RunResult::status is set too.
  Result<NavEstimate> TryFrame(const TrackFrame& frame, TimeNs imu_stamp_ns);

 private:
  Result<NavEstimate> FromData(const TrackFrame& frame);
  Result<NavEstimate> FromTruth(const TrackFrame& frame, TimeNs imu_stamp_ns);

  const EstimatorConfig& config_;
  const MeasurementLog& log_;
  const RunOptions& options_;
  RunResult& result_;
  Initializer initializer_;
};

}  // namespace alidade
