#include "core/gyro_rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/imu_step.h"
#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr TimeNs kMs = 1'000'000;

ImuSample Sample(TimeNs stamp_ns, const Vector3d& gyro) {
  return {.stamp_ns = stamp_ns, .gyro = gyro, .accel = Vector3d::Zero()};
}

TEST(GyroRotation, AStepTurnsByTheMeanOfItsEnds) {
  const Vector3d turn =
      TurnOverStep(Vector3d(1, -2, 0.5), Vector3d(3, -2, 0.1), 0.25, Vector3d(0.5, 1, -0.25));
  EXPECT_LT((turn - 0.25 * Vector3d(1.5, -3, 0.55)).norm(), 1e-15);
}

TEST(GyroRotation, TakenBackSamplesFollowThoseBefore) {
  GyroRotation gyro;
  for (int k = 0; k <= 20; ++k) {
    ASSERT_TRUE(gyro.Add(Sample((k < 10 ? k : k + 50) * 10 * kMs, Vector3d(0, 0, 0.1 * k))));
  }
  EXPECT_FALSE(gyro.Between(0, 200 * kMs));  // half a second without samples
  gyro.TakeBack(600 * kMs, 500 * kMs);
  const auto turn = gyro.Between(0, 200 * kMs);
  ASSERT_TRUE(turn);
  EXPECT_LT((*turn - so3::Exp(Vector3d(0, 0, 0.2))).norm(), 1e-12);
}

// What TurnOverStep leaves out of a hand-held motion after a second, 0.8 rad/s at 1 Hz and 200 samples a
// second, is a hundredth of a pixel at 460 pixels a radian.
TEST(GyroRotation, TheTrapezoidIsAHundredthOfAPixelOff) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 202; ++k) {
    const double angle = 2 * M_PI * (k - 2) / 200.0;
    samples.push_back(Sample((k - 2) * 5 * kMs, 0.8 * Vector3d(std::sin(angle), std::cos(0.7 * angle),
                                                               std::sin(1.1 * angle + 1))));
  }
  SetCurvatures(samples);
  Matrix3d trapezoid = Matrix3d::Identity();
  Matrix3d parabola = Matrix3d::Identity();
  double worst_rad = 0;
  for (size_t k = 3; k < samples.size(); ++k) {
    trapezoid *= so3::Exp(TurnOverStep(samples[k - 1].gyro, samples[k].gyro, 0.005));
    parabola *= so3::Exp(0.005 * MeanOverStep(samples[k - 1], samples[k], {}).gyro);
    worst_rad = std::max(worst_rad, so3::Log(trapezoid.transpose() * parabola).norm());
  }
  EXPECT_LT(worst_rad, 3e-5);
  EXPECT_GT(worst_rad, 1e-5);
}

TEST(GyroRotation, ConstantRateIsExactBetweenSampleTimes) {
  GyroRotation gyro;
  const Vector3d rate(1.0, -2.0, 0.5);
  for (int i = 0; i <= 30; ++i) {
    EXPECT_TRUE(gyro.Add(Sample(i * 5 * kMs, rate)));
  }
  const std::optional<Matrix3d> R = gyro.Between(13 * kMs, 61 * kMs);
  ASSERT_TRUE(R.has_value());
  EXPECT_TRUE(R->isApprox(so3::Exp(rate * 0.048), 1e-12));
  // The next interval still finds the sample before its start.
  ASSERT_TRUE(gyro.Between(61 * kMs, 111 * kMs).has_value());
}

TEST(GyroRotation, ChangingRateAboutOneAxisIntegratesExactly) {
  GyroRotation gyro;
  for (int i = 0; i <= 20; ++i) {  // rate 40 t about z
    gyro.Add(Sample(i * 5 * kMs, Vector3d(0, 0, 40 * 0.005 * i)));
  }
  const std::optional<Matrix3d> R = gyro.Between(7 * kMs, 83 * kMs);
  ASSERT_TRUE(R.has_value());
  EXPECT_NEAR(so3::Log(*R).z(), 20 * (0.083 * 0.083 - 0.007 * 0.007), 1e-12);
}

TEST(GyroRotation, ComposesInTheBodyFrame) {
  GyroRotation gyro;
  gyro.Add(Sample(0, Vector3d(0, 0, 20)));
  gyro.Add(Sample(40 * kMs, Vector3d(0, 0, 20)));
  gyro.Add(Sample(40 * kMs + 1, Vector3d(30, 0, 0)));
  gyro.Add(Sample(80 * kMs, Vector3d(30, 0, 0)));
  const std::optional<Matrix3d> R = gyro.Between(0, 80 * kMs);
  ASSERT_TRUE(R.has_value());
  EXPECT_TRUE(R->isApprox(so3::Exp({0, 0, 0.8}) * so3::Exp({1.2, 0, 0}), 1e-6));
}

TEST(GyroRotation, IsEmptyAcrossAGap) {
  GyroRotation gyro;
  EXPECT_FALSE(gyro.Between(0, 50 * kMs).has_value());
  gyro.Add(Sample(0, Vector3d::Zero()));
  EXPECT_TRUE(gyro.Between(0, 50 * kMs).has_value()) << "the last rate is held over a short time";
  EXPECT_FALSE(gyro.Between(0, 51 * kMs).has_value());
  EXPECT_FALSE(gyro.Between(60 * kMs, 70 * kMs).has_value()) << "too old to be held";
  gyro.Add(Sample(60 * kMs, Vector3d::Zero()));
  EXPECT_FALSE(gyro.Between(0, 70 * kMs).has_value()) << "60 ms without a sample";
  EXPECT_FALSE(gyro.Between(70 * kMs, 70 * kMs).has_value());
}

TEST(GyroRotation, ABiasIsTakenOffTheRate) {
  GyroRotation gyro;
  const Vector3d rate(0.3, -0.1, 0.2);
  const Vector3d bias(0.02, 0.05, -0.04);
  for (int i = 0; i <= 10; ++i) {
    gyro.Add(Sample(i * 5 * kMs, rate + bias));
  }
  EXPECT_TRUE(gyro.Between(0, 50 * kMs, bias)->isApprox(so3::Exp(0.05 * rate), 1e-12));
}

TEST(GyroRotation, WhatIsDroppedChangesNoLaterRotation) {
  GyroRotation gyro;
  for (int i = 0; i <= 20; ++i) {
    gyro.Add(Sample(i * 10 * kMs, Vector3d(0.1 * i, 1, -0.2 * i)));
  }
  const Matrix3d before = gyro.Between(113 * kMs, 180 * kMs).value();
  gyro.DropBefore(113 * kMs);
  EXPECT_EQ(gyro.Between(113 * kMs, 180 * kMs).value(), before);
  EXPECT_FALSE(gyro.Between(30 * kMs, 180 * kMs).has_value());
}

TEST(GyroRotation, IgnoresDisorderAndNotANumber) {
  GyroRotation gyro;
  EXPECT_TRUE(gyro.Add(Sample(10, Vector3d::Zero())));
  EXPECT_FALSE(gyro.Add(Sample(10, Vector3d::Ones())));
  EXPECT_FALSE(gyro.Add(Sample(9, Vector3d::Ones())));
  EXPECT_FALSE(gyro.Add(Sample(20, Vector3d(0, 0, std::nan("")))));
}

// A silence around the times asked for is one too, however near they are to each other.
TEST(GyroRotation, IsEmptyWithinASilence) {
  GyroRotation gyro;
  gyro.Add(Sample(0, Vector3d::Zero()));
  gyro.Add(Sample(1000 * kMs, Vector3d::Ones()));
  EXPECT_FALSE(gyro.Between(400 * kMs, 440 * kMs).has_value());
  GyroRotation later;
  later.Add(Sample(1000 * kMs, Vector3d::Ones()));
  EXPECT_FALSE(later.Between(400 * kMs, 440 * kMs).has_value()) << "held backwards";
  EXPECT_TRUE(later.Between(960 * kMs, 1000 * kMs).has_value());
}

}  // namespace
}  // namespace alidade
