#include "core/imu_step.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

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
  EXPECT_NEAR((exact.alpha - coarse.alpha).norm() / (exact.alpha - fine.alpha).norm(), 8, 1);
  EXPECT_LT(TurnError(exact, fine), 2e-5) << "rad after 1 s; the mean of two samples is off by 2e-4";
  EXPECT_LT((exact.beta - fine.beta).norm(), 2e-4) << "m/s; 2e-3";
  const ImuMotion by_frames = FirstSecond(200, 1.0 / 30);
  EXPECT_LT(TurnError(exact, by_frames), 2e-5) << "intervals that end between samples keep that";
  EXPECT_LT((exact.beta - by_frames.beta).norm(), 2e-4);
}

/// Rate and force of amplitudes in rad/s and m/s^2, whose axes move with 0.7 to 1.1 times the frequency.
struct Shake {
  const char* name;
  double rate_radps;
  double frequency_hz;
  double force_mps2;

  [[nodiscard]] ImuSample operator()(double t_s) const {
    const double w = 2 * M_PI * frequency_hz;
    return {SecondsToNs(t_s),
            rate_radps *
                Vector3d(std::sin(w * t_s), 0.8 * std::cos(0.9 * w * t_s), 0.6 * std::sin(0.7 * w * t_s + 1)),
            Vector3d(force_mps2 * std::sin(1.1 * w * t_s), force_mps2 * std::cos(w * t_s),
                     9.8 + 0.7 * force_mps2 * std::sin(0.9 * w * t_s))};
  }
};

ImuMotion ByMeanOfTwo(const std::vector<ImuSample>& samples) {
  ImuMotion motion;
  for (size_t k = 1; k < samples.size(); ++k) {
    motion = motion * StepIncrement(0.5 * (samples[k - 1].gyro + samples[k].gyro),
                                    0.5 * (samples[k - 1].accel + samples[k].accel),
                                    SecondsBetween(samples[k - 1].stamp_ns, samples[k].stamp_ns), {})
                          .motion;
  }
  return motion;
}

/// The motion at every thirtieth of a second.
std::vector<ImuMotion> MotionAtFrames(const Shake& shake, int rate_hz, bool by_mean_of_two) {
  ImuBuffer buffer(0.5);
  for (int k = -3; k <= rate_hz + 2; ++k) {
    EXPECT_TRUE(buffer.Add(shake(static_cast<double>(k) / rate_hz)).ok());
  }
  std::vector<ImuMotion> motions(1);
  std::vector<ImuSample> samples;
  for (int frame = 0; frame < 30; ++frame) {
    EXPECT_TRUE(buffer.Interval(SecondsToNs(frame / 30.0), SecondsToNs((frame + 1) / 30.0), &samples).ok());
    Preintegration interval({}, {});
    interval.Add(samples);
    motions.push_back(motions.back() * (by_mean_of_two ? ByMeanOfTwo(samples) : interval.motion()));
  }
  return motions;
}

// The table of docs/imu.md: the largest errors within a second.
TEST(ImuStepTest, IsBetterThanTheMeanOfTwoOnEveryMotion) {
  for (const Shake& shake :
       {Shake{"hand-held", 0.8, 1, 2}, Shake{"MAV", 3, 2, 8}, Shake{"vibration", 0.5, 20, 5}}) {
    const std::vector<ImuMotion> exact = MotionAtFrames(shake, 20000, false);
    for (const int rate_hz : {100, 200}) {
      std::cout << "  " << shake.name << ", " << rate_hz << " Hz:";
      std::array<Vector3d, 2> errors = {Vector3d::Zero(), Vector3d::Zero()};
      for (const bool by_mean_of_two : {true, false}) {
        const std::vector<ImuMotion> found = MotionAtFrames(shake, rate_hz, by_mean_of_two);
        Vector3d& error = errors[by_mean_of_two ? 0 : 1];
        for (size_t i = 0; i < found.size(); ++i) {
          error = error.cwiseMax(Vector3d(TurnError(exact[i], found[i]) * 180 / M_PI,
                                          1e3 * (exact[i].beta - found[i].beta).norm(),
                                          1e3 * (exact[i].alpha - found[i].alpha).norm()));
        }
        std::cout << "  " << error[0] << " deg " << error[1] << " mm/s " << error[2] << " mm";
      }
      std::cout << "\n";
      EXPECT_TRUE((2 * errors[1].array() < errors[0].array()).all()) << shake.name << " at " << rate_hz;
    }
  }
}

// GIVEN frames at 30 Hz, between the samples, or at every tenth THEN the intervals compose to the whole.
TEST(ImuStepTest, IntervalsCompose) {
  const ImuMotion whole = FirstSecond(200, 1);
  EXPECT_LT(TurnError(whole, FirstSecond(200, 0.05)), 1e-14);
  EXPECT_LT((whole.beta - FirstSecond(200, 0.05).beta).norm(), 1e-13);
  EXPECT_LT(TurnError(whole, FirstSecond(200, 1.0 / 30)), 2e-6);
  EXPECT_LT((whole.beta - FirstSecond(200, 1.0 / 30).beta).norm(), 2e-5);
}

/// Variance of the turn over white readings at these stamps, against that of the mean of two samples.
double Amplification(const std::vector<double>& stamps_s) {
  RandomStream random(5, "imu step");
  constexpr int kDraws = 4000;
  double by_parabola = 0;
  double by_line = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    ImuBuffer buffer(0.5);
    for (const double stamp_s : stamps_s) {
      EXPECT_TRUE(buffer.Add({SecondsToNs(stamp_s), 1e-3 * random.Normal3(), Vector3d::Zero()}).ok());
    }
    std::vector<ImuSample> samples;
    EXPECT_TRUE(buffer.Interval(SecondsToNs(stamps_s[2]), SecondsToNs(stamps_s.back()), &samples).ok());
    Preintegration interval({}, {});
    interval.Add(samples);
    by_parabola += so3::Log(interval.motion().gamma).squaredNorm();
    Vector3d turn = Vector3d::Zero();
    for (size_t k = 1; k < samples.size(); ++k) {
      turn += 0.5 * SecondsBetween(samples[k - 1].stamp_ns, samples[k].stamp_ns) *
              (samples[k - 1].gyro + samples[k].gyro);
    }
    by_line += turn.squaredNorm();
  }
  return by_parabola / by_line;
}

// GIVEN white noise WHEN the samples of a second are integrated THEN its variance is that of the mean of two
// samples, also where stamps jitter or some are missing.
TEST(ImuStepTest, WhiteNoiseIsNotAmplified) {
  constexpr int kSteps = 40;
  std::vector<double> even, pairs, missing;
  for (int k = 0; k <= kSteps; ++k) {
    even.push_back(0.005 * k);
    pairs.push_back(0.005 * k - (k % 2 == 1 ? 0.004 : 0.0));
    missing.push_back(0.005 * k + (k > kSteps / 2 ? 0.09 : 0.0));
  }
  EXPECT_NEAR(Amplification(even), 1, 0.05);
  EXPECT_LT(Amplification(pairs), 1.1);
  EXPECT_LT(Amplification(missing), 1.1);
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
  late.gyro = Vector3d(0, 4, 0);
  EXPECT_EQ(MeanOverStep(to, late, {}).gyro, Vector3d(1, 2, 0)) << "no coning";
}

}  // namespace
}  // namespace alidade
