#pragma once

#include <cstdint>
#include <vector>

#include "core/imu_sample.h"
#include "core/navigation_state.h"
#include "eval/simulation/continuous_trajectory.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// What the simulated IMU suffers from.
struct SimImuErrors {
  ImuNoise noise;
  double gyro_bias_radps = 0;  ///< standard deviation of the turn-on bias, each axis
  double accel_bias_mps2 = 0;
  double gyro_scale_std = 0;  ///< of each axis' scale factor less one
  double accel_scale_std = 0;
  double misalignment_std_rad = 0;  ///< of each entry off the diagonal, of either sensor
};

struct SimulatedImu {
  std::vector<ImuSample> samples;
  std::vector<ImuBias> biases;                                ///< the true bias in each sample
  Eigen::Matrix3d gyro_matrix = Eigen::Matrix3d::Identity();  ///< M_g: scale and misalignment
  Eigen::Matrix3d accel_matrix = Eigen::Matrix3d::Identity();
};

/// Stamps start_ns + k / rate for k = 0 .. floor(duration * rate), each rounded to the nearest nanosecond by
/// itself, so that rounding does not accumulate. Preconditions: rate_hz > 0, duration_s >= 0.
[[nodiscard]] std::vector<TimeNs> EvenStamps(TimeNs start_ns, double duration_s, double rate_hz);

/// Samples the trajectory's exact angular rate and specific force at `stamps` (time 0 of the trajectory is
/// stamps.front()) and adds biases and noise:
///   measured_k = M true_k + b_k + sigma_c sqrt(rate) n_k,   b_{k+1} = b_k + sigma_wc sqrt(t_{k+1} - t_k) w_k
/// with independent standard normals n, w in streams of their own and M = I + diag(scale errors) +
/// misalignments (off the diagonal), drawn once, independent for the two sensors. rate_hz is the sensor's
/// nominal rate.
[[nodiscard]] SimulatedImu SimulateImu(const ContinuousTrajectory& trajectory,
                                       const std::vector<TimeNs>& stamps, double rate_hz, double gravity_mps2,
                                       const SimImuErrors& errors, std::uint64_t seed);

/// The true states at `stamps` with the given biases, as a truth file carries them.
[[nodiscard]] Trajectory SampleTruth(const ContinuousTrajectory& trajectory,
                                     const std::vector<TimeNs>& stamps, const std::vector<ImuBias>& biases);

}  // namespace alidade
