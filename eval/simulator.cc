#include "eval/simulator.h"

#include <memory>

#include "eval/recorded_motion.h"
#include "eval/sim_camera.h"
#include "eval/sim_gnss.h"
#include "eval/sim_hybrid.h"
#include "eval/sim_imu.h"
#include "eval/sim_landmarks.h"
#include "eval/sim_trajectory.h"

namespace alidade {

namespace {

/// The motion and the stamp of its time 0.
struct SimMotion {
  std::unique_ptr<ContinuousTrajectory> trajectory;
  TimeNs start_ns = 0;
};

Result<SimMotion> MakeMotion(const SimulatorConfig& config, unsigned seed) {
  SimMotion motion;
  if (config.trajectory == SimTrajectory::kFile) {
    const Result<RecordedMotion> recorded = LoadRecordedMotion(config.trajectory_file, config);
    ALIDADE_RETURN_IF_ERROR(recorded.status());
    motion.trajectory = std::make_unique<SplineTrajectory>(recorded->motion);
    motion.start_ns = recorded->motion.start_ns();
  } else {
    motion.trajectory = MakeSimTrajectory(config, seed);
    motion.start_ns = static_cast<TimeNs>(config.start_time_s) * 1000000000;
  }
  return motion;
}

}  // namespace

Result<Dataset> Simulate(const SimulatorConfig& config, unsigned seed) {
  ALIDADE_RETURN_IF_ERROR(config.Validate());
  if (config.IsHybrid()) {
    return SimulateHybrid(config, seed);
  }
  const Result<RigCalibration> rig = MakeSimRig(config);
  ALIDADE_RETURN_IF_ERROR(rig.status());
  const Result<SimMotion> motion = MakeMotion(config, seed);
  ALIDADE_RETURN_IF_ERROR(motion.status());
  const ContinuousTrajectory& trajectory = *motion->trajectory;
  const Result<std::vector<Eigen::Vector3d>> landmarks = MakeLandmarks(config, trajectory, seed);
  ALIDADE_RETURN_IF_ERROR(landmarks.status());

  Dataset dataset;
  dataset.name = config.name;
  dataset.rig = *rig;
  dataset.imu_rate_hz = config.imu_rate_hz;
  dataset.camera_rate_hz = config.camera_rate_hz;

  const double duration_s = trajectory.DurationSeconds();
  const std::vector<TimeNs> imu_stamps = EvenStamps(motion->start_ns, duration_s, config.imu_rate_hz);
  const SimImuErrors errors{config.imu_noise,      config.gyro_bias_radps, config.accel_bias_mps2,
                            config.gyro_scale_std, config.accel_scale_std, config.misalignment_std_rad};
  SimulatedImu imu =
      SimulateImu(trajectory, imu_stamps, config.imu_rate_hz, config.gravity_mps2, errors, seed);
  dataset.truth = SampleTruth(trajectory, imu_stamps, imu.biases);
  dataset.imu = std::move(imu.samples);

  dataset.camera_stamps = EvenStamps(motion->start_ns, duration_s, config.camera_rate_hz);
  dataset.extra_cameras = MakeExtraCameras(config, *rig);
  TakeTracks(SimulateTracks(config, trajectory, *rig, *landmarks, motion->start_ns, dataset.camera_stamps,
                            seed, dataset.extra_cameras),
             &dataset);
  ALIDADE_RETURN_IF_ERROR(AddSimulatedGnss(config, trajectory, motion->start_ns, seed, &dataset));
  return dataset;
}

}  // namespace alidade
