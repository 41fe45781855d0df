#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/eval/run/watched_axes.h"

// Limits of an axis: from the first sample on, on both sides, below what it measured before, close to zero;
// and sensors all of whose axes repeat themselves.

namespace alidade::test {
namespace {

using testing::HasSubstr;

constexpr std::size_t kLong = 4000;

/// Motion, and a gyroscope whose y axis, a cosine of 1 rad/s, is clipped from a sample on.
std::vector<ImuSample> Clipped(double lower, double upper, std::size_t from = 0) {
  std::vector<ImuSample> samples = Motion(kLong, 1e-9);
  for (std::size_t k = from; k < samples.size(); ++k) {
    samples[k].gyro.y() = std::clamp(samples[k].gyro.y(), lower, upper);
  }
  return samples;
}

std::size_t FirstFault(const Watched& watched) {
  return static_cast<std::size_t>(std::find(watched.faulty.begin(), watched.faulty.end(), true) -
                                  watched.faulty.begin());
}

// GIVEN an axis that is clipped in the first sample already THEN it is found within ten, and has noise of
// half its range: how fast it came is not known.
TEST(ImuAxisLimitsTest, AnAxisThatIsClippedFromTheFirstSampleOnIsFound) {
  const Watched watched = Watch(Clipped(-0.6, 0.6));
  EXPECT_EQ(FirstFault(watched), 9u);
  ASSERT_FALSE(watched.reported.empty());
  EXPECT_THAT(watched.reported[0], HasSubstr("the gyroscope's y axis is saturated at 0.6 rad/s from 0.000"));
  double variance = 0;  // of the angle over ten samples
  for (std::size_t k = 0; k < 10; ++k) {
    variance += std::pow(watched.samples[k].gyro_fault_density_radps_sqrthz.y(), 2) / kRateHz;
  }
  EXPECT_NEAR(std::sqrt(variance), 0.3 * 9 / kRateHz, 1e-4);
}

// GIVEN a sensor that does not change in its first samples but for an axis at rest THEN that is no fault.
TEST(ImuAxisLimitsTest, AnAxisAtRestFromTheFirstSampleOnIsNoFault) {
  std::vector<ImuSample> samples = Motion(kLong, 1e-3, 0);
  for (std::size_t k = 0; k < 60; ++k) {
    samples[k].gyro.y() = samples[0].gyro.y();
    samples[k].accel = samples[0].accel;
  }
  EXPECT_TRUE(Watch(std::move(samples)).reported.empty());
}

// GIVEN an axis that is clipped on either side WHEN it comes back to one of the limits THEN it is faulty from
// the first sample there.
TEST(ImuAxisLimitsTest, BothLimitsAreRemembered) {
  const std::vector<ImuSample> samples = Clipped(-0.6, 0.6);
  const Watched watched = Watch(samples);
  std::size_t at_the_limits = 0;
  for (std::size_t k = kLong / 2; k < kLong; ++k) {
    const bool clipped = std::abs(samples[k].gyro.y()) == 0.6;
    ASSERT_EQ(watched.faulty[k], clipped) << k;
    at_the_limits += clipped ? 1 : 0;
  }
  EXPECT_GT(at_the_limits, kLong / 5);
}

// GIVEN an axis that measured more before it is clipped THEN the limit is found when it comes back to it: at
// first it looks like an axis that is stuck.
TEST(ImuAxisLimitsTest, ALimitBelowWhatTheAxisMeasuredBeforeIsFoundWhenItReturns) {
  constexpr std::size_t kFrom = 1000;
  const std::vector<ImuSample> samples = Clipped(-0.6, 0.6, kFrom);
  const Watched watched = Watch(samples);
  std::size_t missed = 0;
  for (std::size_t k = kFrom; k < kLong; ++k) {
    const bool clipped = std::abs(samples[k].gyro.y()) == 0.6;
    missed += clipped && !watched.faulty[k] ? 1 : 0;
    ASSERT_TRUE(clipped || !watched.faulty[k]) << k;
  }
  EXPECT_LE(missed, 20u);  // four or more at the first time on each side, two at the second
  ASSERT_GE(watched.reported.size(), 1u);
  EXPECT_THAT(watched.reported[0], HasSubstr("the gyroscope's y axis repeats"));
  for (std::size_t k = kLong / 2; k < kLong; ++k) {  // as of a saturated axis, in all directions
    const Eigen::Vector3d& densities = watched.samples[k].gyro_fault_density_radps_sqrthz;
    ASSERT_EQ(densities.minCoeff(), densities.maxCoeff()) << k;
  }
}

// GIVEN two axes that are clipped at 0.15 rad/s, which a value of an axis at rest may be, THEN they are
// found.
TEST(ImuAxisLimitsTest, ALimitCloseToZeroIsFound) {
  std::vector<ImuSample> samples = Motion(kLong, 1e-9, 0.2);
  for (ImuSample& sample : samples) {
    sample.gyro.x() = std::clamp(sample.gyro.x(), -0.15, 0.15);
    sample.gyro.y() = std::clamp(sample.gyro.y(), -0.15, 0.15);
  }
  const Watched watched = Watch(samples);
  for (std::size_t k = kLong / 2; k < kLong; ++k) {
    const Eigen::Vector3d& rate = samples[k].gyro;
    ASSERT_EQ(watched.faulty[k], std::abs(rate.x()) == 0.15 || std::abs(rate.y()) == 0.15) << k;
  }
}

/// From `begin` to `end` all axes repeat the values before.
void Freeze(std::size_t begin, std::size_t end, bool gyro, bool accel, std::vector<ImuSample>* samples) {
  for (std::size_t k = begin; k < end; ++k) {
    (*samples)[k].gyro = gyro ? (*samples)[begin - 1].gyro : (*samples)[k].gyro;
    (*samples)[k].accel = accel ? (*samples)[begin - 1].accel : (*samples)[k].accel;
  }
}

// GIVEN a sensor, or both, that hand out the same row for half a second THEN that is reported, and every axis
// of it has noise until it changes again.
TEST(FrozenImuTest, ASensorThatRepeatsAllItsAxesIsFound) {
  for (const auto& [gyro, accel] : {std::pair(true, false), std::pair(false, true), std::pair(true, true)}) {
    std::vector<ImuSample> samples = Motion(kLong, 1e-3);
    Freeze(2000, 2100, gyro, accel, &samples);
    const Watched watched = Watch(samples);
    EXPECT_EQ(watched.reported.size(), 1u) << testing::PrintToString(watched.reported);
    EXPECT_THAT(watched.reported.at(0), HasSubstr(", and so do the others from "));
    for (std::size_t k = 0; k < kLong; ++k) {
      ASSERT_EQ(watched.faulty[k], k >= 2019 && k < 2100) << k;
      if (k >= 2020 && k < 2100) {
        ASSERT_EQ(watched.samples[k].gyro_fault_density_radps_sqrthz.minCoeff() > 0, gyro) << k;
        ASSERT_EQ(watched.samples[k].accel_fault_density_mps2_sqrthz.minCoeff() > 0, accel) << k;
      }
    }
  }
}

// GIVEN a gyroscope of 13 Hz in rows of 200 Hz THEN it is not frozen; WHEN it stops THEN it is, after three
// times as many rows.
TEST(FrozenImuTest, ASlowSensorAmongFastRowsIsNotFrozenUntilItStops) {
  std::vector<ImuSample> samples = Motion(3 * kLong, 1e-9);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].gyro = samples[k - k % 15].gyro;
  }
  Freeze(10000, 10200, true, false, &samples);
  const Watched watched = Watch(samples);
  EXPECT_EQ(FirstFault(watched), 9999u - 9999u % 15 + 3 * 14);
}

// GIVEN a gyroscope all of whose axes are clipped in the first rows THEN that is found, since they are not at
// rest.
TEST(FrozenImuTest, AGyroscopeThatTurnsWithoutAChangeFromTheFirstRowOnIsFrozen) {
  std::vector<ImuSample> samples = Motion(kLong, 1e-3);
  for (std::size_t k = 0; k < 60; ++k) {
    samples[k].gyro = Eigen::Vector3d(0.05, -0.07, 0.3);
  }
  const Watched watched = Watch(std::move(samples));
  EXPECT_EQ(FirstFault(watched), 20u);
  EXPECT_EQ(std::count(watched.faulty.begin(), watched.faulty.end(), true), 40);
}

// GIVEN a gyroscope that does not change at rest THEN it is not frozen, although the accelerometer has noise.
TEST(FrozenImuTest, AGyroscopeAtRestIsNotFrozen) {
  std::vector<ImuSample> samples = Motion(kLong, 1e-3, 0);
  for (ImuSample& sample : samples) {
    sample.gyro.setConstant(0.01);
  }
  EXPECT_TRUE(Watch(std::move(samples)).reported.empty());
}

}  // namespace
}  // namespace alidade::test
