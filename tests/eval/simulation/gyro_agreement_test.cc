#include "eval/simulation/gyro_agreement.h"

#include <gtest/gtest.h>

#include "eval/simulation/sim_imu.h"
#include "eval/simulation/sim_trajectory.h"

namespace alidade {
namespace {

std::vector<ImuSample> SamplesOf(const ContinuousTrajectory& trajectory) {
  SimImuErrors errors;
  errors.noise = {1e-3, 1e-3, 0, 0};
  errors.gyro_bias_radps = 0.01;
  return SimulateImu(trajectory, EvenStamps(0, 60, 100), 100, 9.81, errors, 4).samples;
}

TEST(GyroAgreementTest, FindsBiasOffsetAndNoise) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  std::vector<ImuSample> imu = SamplesOf(*trajectory);
  for (ImuSample& sample : imu) {
    sample.stamp_ns -= 30000000;  // t_motion = t_imu + 30 ms
  }
  const Result<GyroAgreement> gyro = CompareGyro(*trajectory, 0, imu);
  ASSERT_TRUE(gyro.ok()) << gyro.message();
  EXPECT_NEAR(gyro->time_offset_s, 0.030, 1e-3);
  EXPECT_NEAR(gyro->residual_rms_radps, 0.01, 1e-3);
  SimImuErrors errors;
  errors.gyro_bias_radps = 0.01;
  const ImuBias bias = SimulateImu(*trajectory, {0}, 100, 9.81, errors, 4).biases[0];
  EXPECT_LT((gyro->bias - bias.gyro).norm(), 1e-3);
  EXPECT_GT(gyro->correlation, 0.99);
}

TEST(GyroAgreementTest, AnotherBodyFrameShowsAsResidual) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  std::vector<ImuSample> imu = SamplesOf(*trajectory);
  for (ImuSample& sample : imu) {
    sample.gyro = Eigen::Vector3d(sample.gyro.y(), sample.gyro.z(), sample.gyro.x());
  }
  const Result<GyroAgreement> gyro = CompareGyro(*trajectory, 0, imu);
  ASSERT_TRUE(gyro.ok()) << gyro.message();
  EXPECT_GT(gyro->residual_rms_radps, gyro->motion_rms_radps);
  EXPECT_LT(gyro->correlation, 0.5);
}

TEST(GyroAgreementTest, TooFewSamplesAreAnError) {
  const auto trajectory = MakeSimTrajectory(SimulatorConfig());
  const std::vector<ImuSample> imu = SamplesOf(*trajectory);
  EXPECT_EQ(CompareGyro(*trajectory, 1000000000000, imu).code(), StatusCode::kInput);
}

}  // namespace
}  // namespace alidade
