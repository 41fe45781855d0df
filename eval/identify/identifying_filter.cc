#include "eval/identify/identifying_filter.h"

#include "core/imu_propagation.h"
#include "eval/record/runner.h"
#include "filter/filter.h"

namespace alidade {

EstimatorConfig IdentifyingFilter(const EstimatorConfig& config) {
  constexpr double kGrossErrors = 0.9999;
  EstimatorConfig filter = config;
  filter.backend = Backend::kFilter;
  filter.filter.update = UpdateTiming::kDelayedAll;
  filter.filter.track_memory = TrackMemoryPolicy::kNone;
  filter.filter.first_estimates = false;
  filter.filter.slam_features = 0;
  filter.calibration = CalibrationConfig();
  filter.vision.robust_kernel = filter.gnss.robust_kernel = RobustKernel::kNone;
  filter.vision.gate_probability = filter.gnss.gate_probability = kGrossErrors;
  ForEachSensorEntry([&](auto entry, Sensor) {
    entry.Config(filter).robust_kernel = RobustKernel::kNone;
    entry.Config(filter).gate_probability = kGrossErrors;
  });
  return filter;
}

PerNoise AssumedNoise(const EstimatorConfig& config, const MeasurementLog& log) {
  const ImuNoise imu = config.imu.Scaled(log.rig.imu_noise);
  return {imu.gyro_noise_density_radps_sqrthz,
          imu.accel_noise_density_mps2_sqrthz,
          imu.gyro_random_walk_radps2_sqrthz,
          imu.accel_random_walk_mps3_sqrthz,
          config.vision.pixel_noise_px,
          1,
          1};
}

ImuNoise ImuNoiseOf(const PerNoise& noise) {
  return {noise[IndexOf(NoiseSource::kGyro)], noise[IndexOf(NoiseSource::kAccel)],
          noise[IndexOf(NoiseSource::kGyroWalk)], noise[IndexOf(NoiseSource::kAccelWalk)]};
}

void AssumeNoise(const PerNoise& noise, const EstimatorConfig& given, EstimatorConfig* config,
                 MeasurementLog* log) {
  log->rig.imu_noise = ImuNoiseOf(noise);
  config->imu.noise_scale = config->imu.random_walk_scale = 1;
  config->imu.noise = ImuNoiseModel::kSheet;
  config->vision.noise = PixelNoiseModel::kGiven;
  config->vision.pixel_noise_px = noise[IndexOf(NoiseSource::kPixel)];
  const double gnss = noise[IndexOf(NoiseSource::kGnss)];
  config->gnss.corrections.pseudorange_std_m = gnss * given.gnss.corrections.pseudorange_std_m;
  config->gnss.corrections.range_rate_std_mps = gnss * given.gnss.corrections.range_rate_std_mps;
  config->gnss.lasting_errors = false;
  config->gnss.corrections.model_std_scale = gnss * given.gnss.corrections.model_std_scale;
  ForEachSensorEntry([&](auto entry, Sensor) {
    entry.Config(*config).AssumeNoise(entry.Config(given), noise[IndexOf(NoiseSource::kMeasurement)]);
  });
}

Result<LinearSystem> RecordFilter(const EstimatorConfig& config, const MeasurementLog& log,
                                  const RunOptions& options) {
  LinearRecorder recorder(log.rig.imu_noise, GravityInWorld(config.imu.gravity_mps2));
  const std::unique_ptr<Estimator> filter = MakeFilter(config, log.rig, &recorder);
  const RunResult run = RunEstimator(config, log, options, filter.get());
  ALIDADE_RETURN_IF_ERROR(run.status);
  if (run.interrupted) {
    return Status::Diverged("interrupted");
  }
  return recorder.Take();
}

}  // namespace alidade
