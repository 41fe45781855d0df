#include "eval/simulator.h"

#include <memory>

#include "eval/sim_camera.h"
#include "eval/sim_imu.h"
#include "eval/sim_trajectory.h"

namespace alidade {

Result<Dataset> Simulate(const SimulatorConfig& config, unsigned seed) {
  ALIDADE_RETURN_IF_ERROR(config.Validate());
  const Result<RigCalibration> rig = MakeSimRig(config);
  ALIDADE_RETURN_IF_ERROR(rig.status());
  const std::unique_ptr<ContinuousTrajectory> trajectory = MakeSimTrajectory(config);
  const Result<std::vector<Eigen::Vector3d>> landmarks = MakeLandmarks(config, *trajectory, seed);
  ALIDADE_RETURN_IF_ERROR(landmarks.status());

  Dataset dataset;
  dataset.name = config.name;
  dataset.rig = *rig;
  dataset.imu_rate_hz = config.imu_rate_hz;
  dataset.camera_rate_hz = config.camera_rate_hz;

  const TimeNs start_ns = static_cast<TimeNs>(config.start_time_s) * 1000000000;
  const std::vector<TimeNs> imu_stamps = EvenStamps(start_ns, config.duration_s, config.imu_rate_hz);
  const SimImuErrors errors{config.imu_noise, config.gyro_bias_radps, config.accel_bias_mps2};
  SimulatedImu imu =
      SimulateImu(*trajectory, imu_stamps, config.imu_rate_hz, config.gravity_mps2, errors, seed);
  dataset.truth = SampleTruth(*trajectory, imu_stamps, imu.biases);
  dataset.imu = std::move(imu.samples);

  dataset.camera_stamps = EvenStamps(start_ns, config.duration_s, config.camera_rate_hz);
  dataset.tracks =
      SimulateTracks(config, *trajectory, *rig, *landmarks, start_ns, dataset.camera_stamps, seed).frames;
  return dataset;
}

}  // namespace alidade
