#include "core/imu_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/imu_buffer.h"
#include "core/lie.h"
#include "core/preintegration.h"
#include "core/random.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

/// A fast multirotor.
ImuSample At(double t_s) {
  return {SecondsToNs(t_s),
          Vector3d(3 * std::sin(12 * t_s), 2.5 * std::cos(10 * t_s), 1.5 * std::sin(8 * t_s + 1)),
          Vector3d(5 * std::sin(14 * t_s), 8 * std::cos(12 * t_s), 9.8 + 6 * std::sin(13 * t_s))};
}

/// The motion over the first second, integrated in intervals of this length.
ImuMotion FirstSecond(int rate_hz, double interval_s) {
  ImuBuffer buffer(0.5);
  for (int k = -2; k <= rate_hz + 2; ++k) {
    EXPECT_TRUE(buffer.Add(At(static_cast<double>(k) / rate_hz)).ok());
  }
  ImuMotion motion;
  std::vector<ImuSample> samples;
  for (int i = 0; i < std::lround(1 / interval_s); ++i) {
    EXPECT_TRUE(
        buffer.Interval(SecondsToNs(i * interval_s), SecondsToNs((i + 1) * interval_s), &samples).ok());
    Preintegration interval({}, {});
    interval.Add(samples);
    motion = motion * interval.motion();
    buffer.DropBefore(SecondsToNs((i + 1) * interval_s));
  }
  return motion;
}

double TurnError(const ImuMotion& a, const ImuMotion& b) {
  return so3::Log(a.gamma.transpose() * b.gamma).norm();
}

// GIVEN a smooth motion WHEN the rate doubles THEN the error falls to an eighth.
TEST(ImuStepTest, ErrorOnASmoothMotionIsOfThirdOrder) {
  const ImuMotion exact = FirstSecond(20000, 1);
  const ImuMotion coarse = FirstSecond(100, 1);
  const ImuMotion fine = FirstSecond(200, 1);
  EXPECT_NEAR(TurnError(exact, coarse) / TurnError(exact, fine), 8, 1);
  EXPECT_NEAR((exact.beta - coarse.beta).norm() / (exact.beta - fine.beta).norm(), 8, 1);
  EXPECT_LT(TurnError(exact, fine), 2e-5) << "rad after 1 s; the mean of two samples is off by 2e-4";
  EXPECT_LT((exact.beta - fine.beta).norm(), 2e-4) << "m/s; 2e-3";
}

// GIVEN frames at 30 Hz, between the samples, or at every tenth THEN the intervals compose to the whole.
TEST(ImuStepTest, IntervalsCompose) {
  const ImuMotion whole = FirstSecond(200, 1);
  EXPECT_LT(TurnError(whole, FirstSecond(200, 0.05)), 1e-14);
  EXPECT_LT((whole.beta - FirstSecond(200, 0.05).beta).norm(), 1e-13);
  EXPECT_LT(TurnError(whole, FirstSecond(200, 1.0 / 30)), 2e-6);
  EXPECT_LT((whole.beta - FirstSecond(200, 1.0 / 30).beta).norm(), 2e-5);
}

// GIVEN white noise WHEN the samples of a second are integrated THEN its variance is that of its density: the
// parabolas weigh the samples within equally.
TEST(ImuStepTest, WhiteNoiseIsNotAmplified) {
  RandomStream random(5, "imu step");
  constexpr int kDraws = 4000;
  constexpr int kSteps = 40;
  double sum = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    ImuBuffer buffer(0.5);
    for (int k = -2; k <= kSteps; ++k) {
      ASSERT_TRUE(buffer.Add({SecondsToNs(0.01 * k), 1e-3 * random.Normal3(), Vector3d::Zero()}).ok());
    }
    std::vector<ImuSample> samples;
    ASSERT_TRUE(buffer.Interval(0, SecondsToNs(0.01 * kSteps), &samples).ok());
    Preintegration interval({}, {});
    interval.Add(samples);
    sum += so3::Log(interval.motion().gamma).squaredNorm() / (3 * kDraws);
  }
  EXPECT_NEAR(sum / (1e-6 * 1e-4 * kSteps), 1, 0.05);
}

// GIVEN a silence before, or between, the samples THEN the line through them is integrated.
TEST(ImuStepTest, NothingIsKnownAcrossASilence) {
  const ImuSample before{SecondsToNs(0), Vector3d(9, 0, 0), Vector3d::Zero()};
  const ImuSample from{SecondsToNs(0.2), Vector3d(1, 0, 0), Vector3d::Zero()};
  ImuSample to{SecondsToNs(0.21), Vector3d(2, 0, 0), Vector3d::Zero()};
  SetCurvature(before, from, &to);
  EXPECT_DOUBLE_EQ(MeanOverStep(from, to, {}).gyro.x(), 1.5);
  ImuSample late{SecondsToNs(0.4), Vector3d(4, 0, 0), Vector3d::Zero()};
  SetCurvature(from, to, &late);
  EXPECT_DOUBLE_EQ(MeanOverStep(to, late, {}).gyro.x(), 3);
}

}  // namespace
}  // namespace alidade
