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

/// A fast multirotor, as in docs/imu.md.
ImuSample At(double t_s) {
  return {SecondsToNs(t_s),
          Vector3d(3 * std::sin(12 * t_s), 2.5 * std::cos(10 * t_s), 1.5 * std::sin(8 * t_s + 1)),
          Vector3d(5 * std::sin(14 * t_s), 8 * std::cos(12 * t_s), 9.8 + 6 * std::sin(13 * t_s))};
}

/// The motion over the first second, integrated in intervals between times that are multiples of
/// `interval_s`.
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

// GIVEN a smooth motion WHEN the rate doubles THEN the error falls to an eighth or less: it is of third order
// at the ends of an interval, of fourth within.
TEST(ImuStepTest, ErrorOnASmoothMotionIsOfThirdOrder) {
  const ImuMotion exact = FirstSecond(20000, 1);
  const ImuMotion coarse = FirstSecond(100, 1);
  const ImuMotion fine = FirstSecond(200, 1);
  EXPECT_GT(TurnError(exact, coarse), 8 * TurnError(exact, fine));
  EXPECT_GT((exact.beta - coarse.beta).norm(), 8 * (exact.beta - fine.beta).norm());
  EXPECT_LT(TurnError(exact, fine), 1e-5) << "rad after 1 s; the mean of two samples is off by 2e-4";
  EXPECT_LT((exact.beta - fine.beta).norm(), 1e-4) << "m/s; 2e-3";
}

// GIVEN frames at 30 Hz, between the samples THEN what is interpolated at the ends costs little of that.
TEST(ImuStepTest, IntervalsThatEndBetweenSamplesKeepMostOfIt) {
  const ImuMotion exact = FirstSecond(20000, 1);
  EXPECT_LT(TurnError(exact, FirstSecond(200, 1.0 / 30)), 5e-5);
  EXPECT_LT((exact.beta - FirstSecond(200, 1.0 / 30).beta).norm(), 5e-4);
}

// GIVEN white noise WHEN the samples of a second are integrated THEN its variance is that of its density: the
// parabolas weigh the samples within equally.
TEST(ImuStepTest, WhiteNoiseIsNotAmplified) {
  RandomStream random(5, "imu step");
  constexpr int kDraws = 4000;
  constexpr int kSamples = 21;
  double sum = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<ImuSample> samples;
    for (int k = 0; k < kSamples; ++k) {
      samples.push_back({SecondsToNs(0.01 * k), 1e-3 * random.Normal3(), Vector3d::Zero()});
    }
    Preintegration interval({}, {});
    interval.Add(samples);
    sum += so3::Log(interval.motion().gamma).squaredNorm() / (3 * kDraws);
  }
  // The ends count half: kSamples - 1.5 of weight one.
  EXPECT_NEAR(sum / (1e-6 * 1e-4 * (kSamples - 1.5)), 1, 0.08);
}

// GIVEN a silence THEN the line through its ends is integrated, and the samples beyond it do not bend it.
TEST(ImuStepTest, SamplesBeyondASilenceDoNotCount) {
  const std::vector<ImuSample> samples = {{SecondsToNs(0), Vector3d(9, 0, 0), Vector3d::Zero()},
                                          {SecondsToNs(0.01), Vector3d(1, 0, 0), Vector3d::Zero()},
                                          {SecondsToNs(0.3), Vector3d(2, 0, 0), Vector3d::Zero()},
                                          {SecondsToNs(0.31), Vector3d(9, 0, 0), Vector3d::Zero()}};
  EXPECT_DOUBLE_EQ(MeanOverStep(samples, 1, {}).gyro.x(), 1.5);
  EXPECT_DOUBLE_EQ(MeanOverStep(samples, 0, {}).gyro.x(), 5);
  EXPECT_DOUBLE_EQ(OntoParabola(samples[0], samples[1], samples[2],
                                {SecondsToNs(0.155), Vector3d(7, 0, 0), Vector3d::Zero()})
                       .gyro.x(),
                   7);
}

}  // namespace
}  // namespace alidade
