#include "eval/simulation/sim_imu.h"

#include <cmath>

#include "core/random.h"

namespace alidade {
namespace {

/// Scale factors on the diagonal, small angles between true and sensed axes off it.
Eigen::Matrix3d DrawSensorMatrix(double scale_std, double misalignment_std_rad, RandomStream* scale,
                                 RandomStream* misalignment) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.diagonal() += scale_std * scale->Normal3();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      matrix(row, column) += row == column ? 0 : misalignment_std_rad * misalignment->Normal();
    }
  }
  return matrix;
}

}  // namespace

std::vector<TimeNs> EvenStamps(TimeNs start_ns, double duration_s, double rate_hz) {
  // A duration that is a whole number of periods includes its end despite rounding.
  const auto last = static_cast<std::int64_t>(std::floor(duration_s * rate_hz + 1e-6));
  std::vector<TimeNs> stamps;
  stamps.reserve(static_cast<std::size_t>(last) + 1);
  for (std::int64_t k = 0; k <= last; ++k) {
    stamps.push_back(start_ns + std::llround(static_cast<double>(k) * 1e9 / rate_hz));
  }
  return stamps;
}

SimulatedImu SimulateImu(const ContinuousTrajectory& trajectory, const std::vector<TimeNs>& stamps,
                         double rate_hz, double gravity_mps2, const SimImuErrors& errors,
                         std::uint64_t seed) {
  RandomStream turn_on(seed, "imu.turn_on_bias");
  RandomStream gyro_noise(seed, "imu.gyro_noise");
  RandomStream accel_noise(seed, "imu.accel_noise");
  RandomStream gyro_walk(seed, "imu.gyro_walk");
  RandomStream accel_walk(seed, "imu.accel_walk");
  const double gyro_std = errors.noise.gyro_noise_density_radps_sqrthz * std::sqrt(rate_hz);
  const double accel_std = errors.noise.accel_noise_density_mps2_sqrthz * std::sqrt(rate_hz);

  ImuBias bias;
  bias.gyro = errors.gyro_bias_radps * turn_on.Normal3();
  bias.accel = errors.accel_bias_mps2 * turn_on.Normal3();
  SimulatedImu imu;
  RandomStream scale(seed, "imu.scale");
  RandomStream misalignment(seed, "imu.misalignment");
  imu.gyro_matrix =
      DrawSensorMatrix(errors.gyro_scale_std, errors.misalignment_std_rad, &scale, &misalignment);
  imu.accel_matrix =
      DrawSensorMatrix(errors.accel_scale_std, errors.misalignment_std_rad, &scale, &misalignment);
  imu.samples.reserve(stamps.size());
  imu.biases.reserve(stamps.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (k > 0) {
      const double root_dt = std::sqrt(SecondsBetween(stamps[k - 1], stamps[k]));
      bias.gyro += errors.noise.gyro_random_walk_radps2_sqrthz * root_dt * gyro_walk.Normal3();
      bias.accel += errors.noise.accel_random_walk_mps3_sqrthz * root_dt * accel_walk.Normal3();
    }
    const Kinematics motion = trajectory.At(SecondsBetween(stamps.front(), stamps[k]));
    ImuSample sample;
    sample.stamp_ns = stamps[k];
    sample.gyro = imu.gyro_matrix * motion.angular_rate_B + bias.gyro + gyro_std * gyro_noise.Normal3();
    sample.accel = imu.accel_matrix * motion.SpecificForce(gravity_mps2) + bias.accel +
                   accel_std * accel_noise.Normal3();
    imu.samples.push_back(sample);
    imu.biases.push_back(bias);
  }
  return imu;
}

Trajectory SampleTruth(const ContinuousTrajectory& trajectory, const std::vector<TimeNs>& stamps,
                       const std::vector<ImuBias>& biases) {
  Trajectory truth;
  truth.has_velocity = true;
  truth.has_bias = true;
  truth.points.reserve(stamps.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    TrajectoryPoint point;
    point.stamp_ns = stamps[k];
    point.nav = trajectory.At(SecondsBetween(stamps.front(), stamps[k])).nav;
    point.bias = biases[k];
    truth.points.push_back(point);
  }
  return truth;
}

}  // namespace alidade
