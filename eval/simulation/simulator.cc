#include "eval/simulation/simulator.h"

#include <memory>

#include "eval/simulation/recorded_motion.h"
#include "eval/simulation/sim_calibration.h"
#include "eval/simulation/sim_camera.h"
#include "eval/simulation/sim_fault.h"
#include "eval/simulation/sim_fix.h"
#include "eval/simulation/sim_gnss.h"
#include "eval/simulation/sim_hybrid.h"
#include "eval/simulation/sim_imu.h"
#include "eval/simulation/sim_trajectory.h"

namespace alidade {

namespace {

/// A sequence without sensors.
Result<Simulation> MakeMotion(const SimulatorConfig& config, unsigned seed) {
  Simulation simulation;
  if (config.trajectory == SimTrajectory::kFile) {
    const Result<RecordedMotion> recorded = LoadRecordedMotion(config.trajectory_file, config);
    ALIDADE_RETURN_IF_ERROR(recorded.status());
    simulation.motion = std::make_shared<SplineTrajectory>(recorded->motion);
    simulation.motion_start_ns = recorded->motion.start_ns();
  } else {
    simulation.motion = MakeSimTrajectory(config, seed);
    simulation.motion_start_ns = static_cast<TimeNs>(config.start_time_s) * 1000000000;
  }
  return simulation;
}

[[nodiscard]] bool IsMiscalibrated(const SimulatorConfig& config) {
  return config.calibration_rotation_error_rad != 0 || config.calibration_translation_error_m != 0 ||
         config.calibration_time_error_s != 0 || config.calibration_line_delay_error_s != 0 ||
         config.calibration_focal_error_px != 0 || config.calibration_center_error_px != 0 ||
         config.calibration_antenna_error_m != 0;
}

/// What really happens, well calibrated and without failures.
Result<Simulation> SimulateSequence(const SimulatorConfig& config, unsigned seed) {
  if (config.IsHybrid()) {
    return SimulateHybrid(config, seed);
  }
  const Result<RigCalibration> rig = MakeSimRig(config);
  ALIDADE_RETURN_IF_ERROR(rig.status());
  Result<Simulation> simulation = MakeMotion(config, seed);
  ALIDADE_RETURN_IF_ERROR(simulation.status());
  const ContinuousTrajectory& trajectory = *simulation->motion;
  const TimeNs start_ns = simulation->motion_start_ns;

  Dataset& dataset = simulation->dataset;
  dataset.name = config.name;
  dataset.rig = *rig;
  dataset.imu_rate_hz = config.imu_rate_hz;
  dataset.camera_rate_hz = config.camera_rate_hz;

  const double duration_s = trajectory.DurationSeconds();
  const std::vector<TimeNs> imu_stamps = EvenStamps(start_ns, duration_s, config.imu_rate_hz);
  const SimImuErrors errors{config.imu_noise,      config.gyro_bias_radps, config.accel_bias_mps2,
                            config.gyro_scale_std, config.accel_scale_std, config.misalignment_std_rad};
  SimulatedImu imu =
      SimulateImu(trajectory, imu_stamps, config.imu_rate_hz, config.gravity_mps2, errors, seed);
  dataset.truth = SampleTruth(trajectory, imu_stamps, imu.biases);
  dataset.imu = std::move(imu.samples);

  dataset.camera_stamps = EvenStamps(start_ns, duration_s, config.camera_rate_hz);
  if (!config.render.enabled) {
    ALIDADE_RETURN_IF_ERROR(AddSimulatedTracks(config, trajectory, start_ns, seed, &dataset));
  }
  ALIDADE_RETURN_IF_ERROR(AddSimulatedGnss(config, trajectory, start_ns, seed, &dataset));
  AddSimulatedFixes(config, trajectory, start_ns, seed, &dataset);
  return simulation;
}

}  // namespace

Result<Simulation> SimulateWithMotion(const SimulatorConfig& config, unsigned seed) {
  ALIDADE_RETURN_IF_ERROR(config.Validate());
  Result<Simulation> simulation = SimulateSequence(config, seed);
  ALIDADE_RETURN_IF_ERROR(simulation.status());
  Dataset& dataset = simulation->dataset;
  if (config.fault != SimFaultKind::kNone) {
    ApplyFault(config, seed, dataset.imu.front().stamp_ns, &dataset);
  }
  if (IsMiscalibrated(config)) {
    const Result<RigCalibration> wrong = MiscalibratedRig(config, dataset.rig, seed);
    ALIDADE_RETURN_IF_ERROR(wrong.status());
    dataset.true_rig = dataset.rig;
    dataset.rig = *wrong;
  }
  return simulation;
}

Result<Dataset> Simulate(const SimulatorConfig& config, unsigned seed) {
  Result<Simulation> simulation = SimulateWithMotion(config, seed);
  ALIDADE_RETURN_IF_ERROR(simulation.status());
  return std::move(simulation->dataset);
}

}  // namespace alidade
