#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/imu_sample.h"
#include "eval/simulation/fault_span.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Magnitude at which each axis is clipped by the faults of saturation: |m| + share (M - |m|), m the mean and
/// M the largest magnitude of the axis over `samples`. The limit belongs to the sensor, so it does not depend
/// on the time of the fault; gravity alone does not exceed it.
[[nodiscard]] Eigen::Vector3d SaturationLimits(const std::vector<ImuSample>& samples,
                                               Eigen::Vector3d ImuSample::*signal, double share);

/// Applies SimulatorConfig::fault to inertial samples where it is one of the IMU. Within `span`: imu and
/// blackout_and_imu: rates and specific forces are uniform in +-3 rad/s and +-30 m/s^2. imu_gap: no samples.
/// gyro_spike, accel_spike: 30 rad/s or 490 m/s^2 (50 g) in a random direction are added to one sample, drawn
/// from those of the fault. gyro_saturation, accel_saturation: each axis is clipped at its limit
/// (SaturationLimits with fault_limit_share). gyro_stuck, accel_stuck: one axis, which the seed draws,
/// repeats its last value from before the span (the first one in it where there is none); gyro_frozen,
/// imu_frozen: so do all axes of the gyroscope, of both sensors. From the beginning
/// of the span to the end of the sequence: imu_unit: the gyroscope is in deg/s. imu_clock: stamps have
/// fault_clock_jump_s more.
void ApplyImuFault(const SimulatorConfig& config, std::uint64_t seed, const FaultSpan& span,
                   std::vector<ImuSample>* imu);

}  // namespace alidade
