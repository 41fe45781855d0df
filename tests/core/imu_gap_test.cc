#include "core/imu_gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/imu_buffer.h"
#include "core/preintegration.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kRateHz = 100;
constexpr ImuNoise kSheet{2e-4, 2e-3, 2e-5, 3e-3};

/// Two seconds without the samples strictly between `silent_s` and `silent_s` + `gap_s`.
ImuBuffer Buffer(double silent_s, double gap_s) {
  ImuBuffer buffer(0.5);
  for (int k = 0; k <= 200; ++k) {
    const double t = k / kRateHz;
    if (t <= silent_s + 1e-9 || t >= silent_s + gap_s - 1e-9) {
      EXPECT_TRUE(buffer.Add({SecondsToNs(t), Vector3d::Zero(), Vector3d(0, 0, 9.81)}).ok());
    }
  }
  return buffer;
}

/// Standard deviation of the rotation and of the velocity over [from, to], frame by frame every `step_s`.
std::pair<double, double> Deviations(ImuBuffer* buffer, double from_s, double to_s, double step_s) {
  ImuIncrement all;
  std::vector<ImuSample> samples;
  for (const double t : test::Steps(from_s, to_s - 1e-9, step_s)) {
    EXPECT_TRUE(buffer->Interval(SecondsToNs(t), SecondsToNs(t + step_s), &samples).ok());
    Preintegration part(ImuBias(), kSheet);
    part.Add(samples);
    ImuIncrement next;
    next.motion = part.motion();
    next.bias_jacobian = part.bias_jacobian();
    next.covariance = part.covariance();
    all.Append(next);
  }
  return {std::sqrt(all.covariance(0, 0)), std::sqrt(all.covariance(8, 8))};
}

TEST(ImuGapTest, ShortIntervalsBetweenSamplesAreThoseOfASlowImu) {
  ImuBuffer with = Buffer(1, 0.1);
  ImuBuffer without = Buffer(1, 0.01);
  EXPECT_NEAR(Deviations(&with, 0.5, 1.5, 0.05).first, Deviations(&without, 0.5, 1.5, 0.05).first, 1e-9);
}

// GIVEN a silence of a second, WHEN frames fall into it, THEN what is not known of the motion over the whole
// silence does not depend on how many they are, and is that of a constant error of the floors.
TEST(ImuGapTest, TheUncertaintyOfASilenceDoesNotDependOnTheFramesInIt) {
  for (const double step_s : {0.05, 0.1, 0.25, 1.0}) {
    ImuBuffer buffer = Buffer(0.5, 1);
    const auto [rotation, velocity] = Deviations(&buffer, 0.5, 1.5, step_s);
    EXPECT_NEAR(rotation, 0.2, 1e-3) << step_s;
    EXPECT_NEAR(velocity, 1, 0.01) << step_s;
  }
}

TEST(ImuGapTest, WhatHasChangedMeanwhileCounts) {
  const ImuSample before{0, Vector3d::Zero(), Vector3d(0, 0, 9.81)};
  const ImuSample after{SecondsToNs(0.5), Vector3d(0, 2, 0), Vector3d(6, 0, 9.81)};
  ASSERT_TRUE(imu_gap::IsInside(before, after));
  const ImuNoise noise = imu_gap::AddNoise(before, after, kSheet);
  EXPECT_NEAR(noise.gyro_noise_density_radps_sqrthz, 1 * std::sqrt(0.5), 1e-4);
  EXPECT_NEAR(noise.accel_noise_density_mps2_sqrthz, 3 * std::sqrt(0.5), 1e-4);
  const ImuSample middle = Interpolate(before, after, SecondsToNs(0.2));
  EXPECT_NEAR(imu_gap::AddNoise(middle, after, kSheet).gyro_noise_density_radps_sqrthz,
              noise.gyro_noise_density_radps_sqrthz, 1e-9);
}

}  // namespace
}  // namespace alidade
