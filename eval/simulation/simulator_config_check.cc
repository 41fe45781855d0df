#include <cmath>

#include "core/format.h"
#include "eval/files/input_file.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {
namespace {

Status Expect(bool holds, const char* key, double value, const std::string& expected) {
  return holds ? Status::Ok()
               : Status::Config(std::string(key) + ": " + Format("%g", value) + "; expected " + expected);
}

Status ValidateRecording(const SimulatorConfig& config) {
  if (config.hybrid_dataset == kRequiredPath || config.trajectory_file == kRequiredPath) {
    const std::string key = config.hybrid_dataset == kRequiredPath ? "hybrid_dataset" : "trajectory_file";
    return Status::Config(key + ": required; expected a path, as in the setting " + key + "=FOLDER");
  }
  const bool reads_file = config.trajectory == SimTrajectory::kFile && !config.IsHybrid();
  if (reads_file && config.trajectory_file == kNoPath) {
    return Status::Config("trajectory_file: none; trajectory: file expected a path");
  }
  if (config.camera_view == SimCameraView::kDataset && !config.IsHybrid() &&
      !(reads_file && MayBeFolder(config.trajectory_file))) {
    return Status::Config(
        "camera_view: dataset; expected trajectory: file and a dataset folder in trajectory_file");
  }
  ALIDADE_RETURN_IF_ERROR(Expect(std::isfinite(config.knot_spacing_s) && config.knot_spacing_s > 0,
                                 "knot_spacing_s", config.knot_spacing_s, "a positive number"));
  return Expect(config.max_gap_s > 0, "max_gap_s", config.max_gap_s, "a positive number");
}

/// What the keys of analytic trajectories must fulfil together.
Status ValidateMotion(const SimulatorConfig& config) {
  const double least_s = config.pause_s + 2 * config.rest_ramp_s;
  ALIDADE_RETURN_IF_ERROR(Expect(config.pause_s == 0 || least_s < config.pause_period_s, "pause_period_s",
                                 config.pause_period_s,
                                 "more than pause_s and two of rest_ramp_s, " + Format("%g", least_s)));
  // An open path is walked from end to end: this bounds the work.
  const bool drifts =
      config.trajectory == SimTrajectory::kWander || config.trajectory == SimTrajectory::kHover;
  ALIDADE_RETURN_IF_ERROR(Expect(!drifts || config.path_m < 1e4 * (config.length_m + config.width_m),
                                 "path_m", config.path_m, "less than 1e4 times length_m + width_m"));
  ALIDADE_RETURN_IF_ERROR(
      Expect(config.trajectory != SimTrajectory::kSpiral || config.path_m < 1e4 * config.length_m, "path_m",
             config.path_m, "less than 1e4 times length_m on a spiral"));
  const bool recorded = config.trajectory == SimTrajectory::kFile || config.IsHybrid();
  if (recorded && config.path_point == SimPathPoint::kCamera) {
    return Status::Config(
        "path_point: camera; expected body with a recorded trajectory, which is the body's");
  }
  return Status::Ok();
}

Status ValidateFault(const SimulatorConfig& config) {
  const SimFaultKind fault = config.fault;
  if (config.render.enabled && (fault == SimFaultKind::kTracks || fault == SimFaultKind::kCameraClock)) {
    return Status::Config(
        "fault: tracks and camera_clock are faults of simulated tracks; expected "
        "render.enabled: false");
  }
  if (!config.render.enabled && (fault == SimFaultKind::kGlare || fault == SimFaultKind::kBlur)) {
    return Status::Config("fault: glare and blur are faults of images; expected render.enabled: true");
  }
  if (fault == SimFaultKind::kStaleEphemerides &&
      (config.gnss.rate_hz == 0 || config.gnss.navigation_file != kNoPath)) {
    return Status::Config(
        "fault: stale_ephemerides replaces the simulated ephemerides; expected gnss.rate_hz greater than 0 "
        "and gnss.navigation_file: none");
  }
  ALIDADE_RETURN_IF_ERROR(Expect(fault != SimFaultKind::kImuClock || config.fault_clock_jump_s > 0,
                                 "fault_clock_jump_s", config.fault_clock_jump_s,
                                 "greater than 0 with fault: imu_clock, as stamps must increase"));
  return Status::Ok();
}

}  // namespace

Status SimulatorConfig::Validate() const {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  ALIDADE_RETURN_IF_ERROR(Expect(positive(duration_s), "duration_s", duration_s, "a positive number"));
  ALIDADE_RETURN_IF_ERROR(Expect(positive(imu_rate_hz), "imu_rate_hz", imu_rate_hz, "a positive number"));
  ALIDADE_RETURN_IF_ERROR(
      Expect(positive(camera_rate_hz), "camera_rate_hz", camera_rate_hz, "a positive number"));
  ALIDADE_RETURN_IF_ERROR(Expect(positive(length_m), "length_m", length_m, "a positive number"));
  ALIDADE_RETURN_IF_ERROR(Expect(positive(width_m), "width_m", width_m, "a positive number"));
  ALIDADE_RETURN_IF_ERROR(Expect(positive(path_m), "path_m", path_m, "a positive number"));
  ALIDADE_RETURN_IF_ERROR(
      Expect(duration_s * imu_rate_hz < 1e8, "duration_s", duration_s, "less than 1e8 IMU samples"));
  ALIDADE_RETURN_IF_ERROR(Expect(rest_s == 0 || rest_s + rest_ramp_s < duration_s, "rest_s", rest_s,
                                 "rest_s + rest_ramp_s less than duration_s " + Format("%g", duration_s)));
  ALIDADE_RETURN_IF_ERROR(ValidateMotion(*this));
  ALIDADE_RETURN_IF_ERROR(ValidateRecording(*this));
  ALIDADE_RETURN_IF_ERROR(ValidateSensors());
  // GPST began in 1980; readers accept the years to 2099.
  ALIDADE_RETURN_IF_ERROR(Expect(
      gnss.rate_hz == 0 || trajectory == SimTrajectory::kFile || IsHybrid() || start_time_s >= 400000000,
      "start_time_s", start_time_s, "at least 4e8 with gnss.rate_hz: stamps are then GPST"));
  ALIDADE_RETURN_IF_ERROR(
      Expect(landmark_layout == SimLandmarkLayout::kRoom || landmark_min_distance_m < landmark_max_distance_m,
             "landmark_min_distance_m", landmark_min_distance_m,
             "less than landmark_max_distance_m " + Format("%g", landmark_max_distance_m)));
  ALIDADE_RETURN_IF_ERROR(Expect(camera_lever_arm_m.norm() < landmark_min_distance_m, "camera_lever_arm_m",
                                 camera_lever_arm_m.norm(), "shorter than landmark_min_distance_m"));
  ALIDADE_RETURN_IF_ERROR(
      Expect(!render.enabled || camera_count == 1, "camera_count", camera_count, "1 with render.enabled"));
  ALIDADE_RETURN_IF_ERROR(ValidateFault(*this));
  ALIDADE_RETURN_IF_ERROR(render.Validate());
  for (int i = CoefficientCount(distortion); i < 4; ++i) {
    ALIDADE_RETURN_IF_ERROR(
        Expect(distortion_coefficients[i] == 0, "distortion coefficient", distortion_coefficients[i],
               "0 at position " + std::to_string(i + 1) + " of model " + std::string(ToString(distortion))));
  }
  return Status::Ok();
}

}  // namespace alidade
