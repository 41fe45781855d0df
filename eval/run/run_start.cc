#include "eval/run/run_start.h"

#include "eval/run/truth_start.h"

namespace alidade {

RunStart::RunStart(const EstimatorConfig& config, const MeasurementLog& log, const RunOptions& options,
                   RunResult* result)
    : config_(config), log_(log), options_(options), result_(*result), initializer_(config, log.rig) {}

Result<NavEstimate> RunStart::TryFrame(const TrackFrame& frame, TimeNs imu_stamp_ns) {
  return config_.init.method == InitMethod::kTruth ? FromTruth(frame, imu_stamp_ns) : FromData(frame);
}

Result<NavEstimate> RunStart::FromData(const TrackFrame& frame) {
  Result<NavEstimate> start = initializer_.AddFrame(frame);
  if (start.ok()) {
    result_.init_method = initializer_.method();
    result_.init_report = initializer_.report();
  }
  return start;
}

Result<NavEstimate> RunStart::FromTruth(const TrackFrame& frame, TimeNs imu_stamp_ns) {
  if (options_.truth == nullptr) {
    result_.status = Status::Input(
        "init.method: found truth, but the sequence has no ground truth; expected static, "
        "dynamic or auto");
    return result_.status;
  }
  if (!options_.truth->has_velocity || !options_.truth->has_bias) {
    result_.status = StartFromTruth(config_.init, *options_.truth, imu_stamp_ns, options_.seed).status();
    return result_.status;
  }
  if (log_.imu.empty() || imu_stamp_ns < log_.imu.front().stamp_ns) {
    return Status::Input("no IMU sample before the frame at " + FormatSeconds(frame.stamp_ns) + " s");
  }
  Result<NavEstimate> start = StartFromTruth(config_.init, *options_.truth, imu_stamp_ns, options_.seed);
  if (start.ok()) {
    result_.init_method = "truth";
    result_.init_report =
        config_.init.perturb_truth
            ? "truth, moved by an error drawn from the prior with seed " + std::to_string(options_.seed)
            : "truth itself";
  }
  return start;
}

}  // namespace alidade
