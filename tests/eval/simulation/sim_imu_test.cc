#include "eval/simulation/sim_imu.h"

#include <gtest/gtest.h>

#include <cmath>

#include "eval/simulation/sim_trajectory.h"

namespace alidade {
namespace {

/// Distance between the truth and the midpoint-rule integral of noise-free IMU samples after `duration_s`.
double IntegrationErrorMetres(const SimulatorConfig& config, double rate_hz, double duration_s) {
  const auto trajectory = MakeSimTrajectory(config);
  SimImuErrors none;
  none.noise = {0, 0, 0, 0};
  const std::vector<TimeNs> stamps = EvenStamps(5, duration_s, rate_hz);
  const SimulatedImu imu = SimulateImu(*trajectory, stamps, rate_hz, 9.81, none, 1);
  NavState state = trajectory->At(0).nav;
  const Eigen::Vector3d g_W(0, 0, -9.81);
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    const double dt = SecondsBetween(stamps[k - 1], stamps[k]);
    const Eigen::Matrix3d R_next =
        state.R_WB * so3::Exp(0.5 * (imu.samples[k - 1].gyro + imu.samples[k].gyro) * dt);
    const Eigen::Vector3d a_W =
        0.5 * (state.R_WB * imu.samples[k - 1].accel + R_next * imu.samples[k].accel) + g_W;
    state.p_WB += state.v_WB * dt + 0.5 * a_W * dt * dt;
    state.v_WB += a_W * dt;
    state.R_WB = R_next;
  }
  return (state.p_WB - trajectory->At(SecondsBetween(stamps.front(), stamps.back())).nav.p_WB).norm();
}

TEST(SimImuTest, NoiseFreeSamplesIntegrateToTheTruth) {
  SimulatorConfig config;
  EXPECT_LT(IntegrationErrorMetres(config, 1000, 20), 1e-3);
  config.rest_s = 5;
  EXPECT_LT(IntegrationErrorMetres(config, 1000, 20), 1e-3);
  config.trajectory = SimTrajectory::kEllipse;
  EXPECT_LT(IntegrationErrorMetres(config, 1000, 20), 1e-3);
}

TEST(SimImuTest, IntegrationErrorFallsWithTheSquareOfTheStep) {
  // Only samples that are exact derivatives let a second-order rule converge at second order.
  const SimulatorConfig config;
  const double coarse = IntegrationErrorMetres(config, 100, 20);
  const double fine = IntegrationErrorMetres(config, 400, 20);
  EXPECT_NEAR(coarse / fine, 16, 1);
}

TEST(SimImuTest, StampsAreExactAndDoNotDrift) {
  const std::vector<TimeNs> stamps = EvenStamps(1000000000, 200, 100);
  ASSERT_EQ(stamps.size(), 20001u);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    ASSERT_EQ(stamps[k], 1000000000 + static_cast<TimeNs>(k) * 10000000);
  }
  const std::vector<TimeNs> thirds = EvenStamps(0, 10, 3);
  ASSERT_EQ(thirds.size(), 31u);
  EXPECT_EQ(thirds[1], 333333333);
  EXPECT_EQ(thirds[30], 10000000000);
}

/// Sample standard deviation over all axes must lie within 3 sigma of its expectation: relative 1 / sqrt(2
/// n).
void ExpectStd(double sum_of_squares, double count, double expected) {
  EXPECT_NEAR(std::sqrt(sum_of_squares / count) / expected, 1, 3 / std::sqrt(2 * count));
}

TEST(SimImuTest, NoiseHasTheStatisticsItWasGiven) {
  const SimulatorConfig config;
  const auto trajectory = MakeSimTrajectory(config);
  SimImuErrors errors;
  errors.noise = {3e-4, 1e-3, 3e-5, 2e-4};
  const std::vector<TimeNs> stamps = EvenStamps(0, 200, 100);
  const SimulatedImu imu = SimulateImu(*trajectory, stamps, 100, 9.81, errors, 11);
  double gyro = 0;
  double accel = 0;
  double gyro_walk = 0;
  double accel_walk = 0;
  for (std::size_t k = 1; k < stamps.size(); ++k) {
    const Kinematics motion = trajectory->At(SecondsBetween(stamps[0], stamps[k]));
    gyro += (imu.samples[k].gyro - imu.biases[k].gyro - motion.angular_rate_B).squaredNorm();
    accel += (imu.samples[k].accel - imu.biases[k].accel - motion.SpecificForce(9.81)).squaredNorm();
    gyro_walk += (imu.biases[k].gyro - imu.biases[k - 1].gyro).squaredNorm();
    accel_walk += (imu.biases[k].accel - imu.biases[k - 1].accel).squaredNorm();
  }
  const double count = 3.0 * static_cast<double>(stamps.size() - 1);
  ExpectStd(gyro, count, 3e-4 * 10);
  ExpectStd(accel, count, 1e-3 * 10);
  ExpectStd(gyro_walk, count, 3e-5 * 0.1);
  ExpectStd(accel_walk, count, 2e-4 * 0.1);
}

TEST(SimImuTest, ScaleAndMisalignmentAreConstantAndHaveTheirStatistics) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  SimImuErrors errors;
  errors.noise = {0, 0, 0, 0};
  errors.gyro_scale_std = 0.01;
  errors.accel_scale_std = 0.005;
  errors.misalignment_std_rad = 0.002;
  double gyro = 0;
  double accel = 0;
  double angles = 0;
  constexpr int kSeeds = 300;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const std::vector<TimeNs> stamps = EvenStamps(0, 0.1, 100);
    const SimulatedImu imu =
        SimulateImu(*trajectory, stamps, 100, 9.81, errors, static_cast<std::uint64_t>(seed));
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      const Kinematics motion = trajectory->At(SecondsBetween(0, stamps[k]));
      ASSERT_LT((imu.samples[k].gyro - imu.gyro_matrix * motion.angular_rate_B).norm(), 1e-12);
      ASSERT_LT((imu.samples[k].accel - imu.accel_matrix * motion.SpecificForce(9.81)).norm(), 1e-12);
    }
    const Eigen::Matrix3d gyro_error = imu.gyro_matrix - Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d accel_error = imu.accel_matrix - Eigen::Matrix3d::Identity();
    gyro += gyro_error.diagonal().squaredNorm();
    accel += accel_error.diagonal().squaredNorm();
    angles += gyro_error.squaredNorm() - gyro_error.diagonal().squaredNorm();
    angles += accel_error.squaredNorm() - accel_error.diagonal().squaredNorm();
  }
  ExpectStd(gyro, 3.0 * kSeeds, 0.01);
  ExpectStd(accel, 3.0 * kSeeds, 0.005);
  ExpectStd(angles, 12.0 * kSeeds, 0.002);
}

TEST(SimImuTest, TurnOnBiasHasTheStatisticsItWasGiven) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  SimImuErrors errors;
  errors.gyro_bias_radps = 0.005;
  errors.accel_bias_mps2 = 0.05;
  double gyro = 0;
  double accel = 0;
  constexpr int kSeeds = 400;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const SimulatedImu imu =
        SimulateImu(*trajectory, {0}, 100, 9.81, errors, static_cast<std::uint64_t>(seed));
    gyro += imu.biases[0].gyro.squaredNorm();
    accel += imu.biases[0].accel.squaredNorm();
  }
  ExpectStd(gyro, 3.0 * kSeeds, 0.005);
  ExpectStd(accel, 3.0 * kSeeds, 0.05);
}

}  // namespace
}  // namespace alidade
