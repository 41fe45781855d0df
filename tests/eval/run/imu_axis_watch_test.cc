#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/eval/run/watched_axes.h"

namespace alidade::test {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

TEST(ImuAxisWatchTest, MotionPassesUntouchedHoweverCoarseTheSensor) {
  for (const double step : {1e-9, 1e-3, 4e-3}) {
    const Watched watched = Watch(Motion(20000, step));
    EXPECT_TRUE(watched.reported.empty()) << step << ": " << watched.reported.front();
    for (const ImuSample& sample : watched.samples) {
      ASSERT_TRUE(sample.gyro_fault_density_radps_sqrthz.isZero(0));
      ASSERT_TRUE(sample.accel_fault_density_mps2_sqrthz.isZero(0));
    }
  }
}

// At rest a coarse sensor repeats itself: noise of a quarter of its resolution.
TEST(ImuAxisWatchTest, ACoarseSensorAtRestIsNoFault) {
  EXPECT_TRUE(Watch(Motion(20000, 4e-3, 0)).reported.empty());
}

// Without noise a level motion has the same vertical force throughout, but for rounding.
TEST(ImuAxisWatchTest, AnAxisThatSeldomChangedBeforeIsNoFault) {
  std::vector<ImuSample> samples = Motion(4000, 1e-9);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    samples[k].accel.z() = k % 50 == 0 ? 9.81 + 1e-14 : 9.81;
  }
  EXPECT_TRUE(Watch(std::move(samples)).reported.empty());
}

// GIVEN noise-free data WHEN a level motion follows a longer one in three dimensions THEN what the axis does
// now shows that it is not stuck, not what it did then.
TEST(ImuAxisWatchTest, ALevelMotionAfterOneInThreeDimensionsIsNoFaultForLong) {
  std::vector<ImuSample> samples = Motion(20000, 1e-9);
  for (std::size_t k = 10000; k < samples.size(); ++k) {
    samples[k].accel.z() = k % 50 == 0 ? 9.81 + 1e-14 : 9.81;
  }
  const Watched watched = Watch(std::move(samples));
  for (std::size_t k = 12000; k < watched.faulty.size(); ++k) {
    ASSERT_FALSE(watched.faulty[k]) << k;
  }
}

/// A coarse accelerometer, whose vertical axis jumps at 10 s to the largest value so far and rests there. All
/// repeat themselves but for every third measurement of the horizontal axes and every `period`-th of the
/// vertical one, a step lower.
std::vector<ImuSample> PutDown(std::size_t period) {
  constexpr double kStep = 0.04;
  std::vector<ImuSample> samples = Motion(10000, 4e-3);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k < 2000) {
      samples[k].accel.z() = kStep * (std::round(samples[k].accel.z() / kStep) - 100);
    } else {
      const double step = k % 3 == 0 ? kStep : 0;
      samples[k].accel = Vector3d(step, -step, kStep * (k % period == 1 ? 244 : 245));
    }
  }
  return samples;
}

// GIVEN a coarse accelerometer that is put down quickly THEN it is taken for saturated for a second at most,
// whether its noise moves it at rest or not.
TEST(ImuAxisWatchTest, ACoarseSensorThatIsPutDownQuicklyIsNotSaturatedForTheWholeRest) {
  for (const std::size_t period : {100000u, 101u, 22u}) {
    const Watched watched = Watch(PutDown(period));
    for (std::size_t k = 0; k < watched.faulty.size(); ++k) {
      const double rest_s = (static_cast<double>(k) - 2000) / kRateHz;
      ASSERT_FALSE(watched.faulty[k] && rest_s > ImuAxisWatch::kConstantS + 0.2) << period << " " << rest_s;
    }
  }
}

// GIVEN an axis that is saturated for long WHEN the others go on moving THEN it is faulty throughout, and
// reported once.
TEST(ImuAxisWatchTest, ALongSaturationIsFoundThroughoutWhileTheOthersMove) {
  std::vector<ImuSample> samples = Motion(4000, 1e-3);
  for (std::size_t k = 2000; k < 3000; ++k) {
    samples[k].gyro.x() = 1.2;
  }
  const Watched watched = Watch(std::move(samples));
  ASSERT_EQ(watched.reported.size(), 1u);
  EXPECT_THAT(watched.reported[0], HasSubstr("the gyroscope's x axis is saturated at 1.2 rad/s"));
  for (std::size_t k = 0; k < watched.faulty.size(); ++k) {
    EXPECT_EQ(watched.faulty[k], k >= 2004 && k < 3000) << k;
  }
}

// GIVEN an axis that is clipped at a small value, which counts as stuck, THEN its noise is in all axes, as
// that of a saturated one.
TEST(ImuAxisWatchTest, TheNoiseOfAnAxisThatSticksAtItsLargestValueIsInAllAxes) {
  std::vector<ImuSample> samples = Motion(4000, 1e-3);
  for (ImuSample& sample : samples) {
    sample.gyro.x() = std::min(sample.gyro.x(), 0.15);
  }
  const Watched watched = Watch(std::move(samples));
  ASSERT_FALSE(watched.reported.empty());
  EXPECT_THAT(watched.reported[0], HasSubstr("the gyroscope's x axis repeats 0.15 rad/s"));
  std::size_t noisy = 0;
  for (std::size_t k = 0; k < watched.faulty.size(); ++k) {
    const Eigen::Vector3d& densities = watched.samples[k].gyro_fault_density_radps_sqrthz;
    EXPECT_EQ(densities.minCoeff(), densities.maxCoeff()) << k;
    noisy += densities.z() > 0 ? 1 : 0;
  }
  EXPECT_GT(noisy, 1000u);
}

TEST(ImuAxisWatchTest, RowsThatAreHandedOutTwiceAreNoFault) {
  std::vector<ImuSample> samples = Motion(8000, 1e-9);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const ImuSample& first = samples[k - k % 25];
    samples[k].gyro = first.gyro;
    samples[k].accel = first.accel;
  }
  EXPECT_TRUE(Watch(std::move(samples)).reported.empty());
}

// GIVEN two axes that are clipped at once, for longer than a second, while the third one moves, THEN both are
// saturated throughout.
TEST(ImuAxisWatchTest, AxesThatAreClippedTogetherAreSaturatedThroughout) {
  std::vector<ImuSample> samples = Motion(6000, 1e-9);
  for (std::size_t k = 2200; k < 2800; ++k) {
    samples[k].gyro.y() = 1.1;
    samples[k].gyro.z() = 1.2;
  }
  const Watched watched = Watch(samples);
  for (std::size_t k = 2210; k < 2800; ++k) {
    ASSERT_TRUE(watched.faulty[k]) << k;
    ASSERT_GT(watched.samples[k].gyro_fault_density_radps_sqrthz.minCoeff(), 0) << k;
  }
}

TEST(ImuAxisWatchTest, AStuckAxisIsReportedOnceWithAxisValueAndStampAndGetsItsNoise) {
  std::vector<ImuSample> samples = Motion(4000, 1e-9);
  for (std::size_t k = 2000; k < 3000; ++k) {
    samples[k].gyro.y() = samples[1999].gyro.y();
  }
  const Watched watched = Watch(samples);
  ASSERT_EQ(watched.reported.size(), 1u);
  EXPECT_THAT(watched.reported[0], HasSubstr("the gyroscope's y axis repeats "));
  EXPECT_THAT(watched.reported[0], HasSubstr("from 9.995"));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_EQ(watched.faulty[k], k >= 2003 && k < 3000) << k;
    EXPECT_EQ(watched.samples[k].gyro.x(), samples[k].gyro.x());
    EXPECT_EQ(watched.samples[k].gyro.z(), samples[k].gyro.z());
    if (watched.faulty[k]) {  // the mean before, which differs from that of a period by the memory's end
      EXPECT_NEAR(watched.samples[k].gyro.y(), 0, 0.25) << k;
      EXPECT_EQ(watched.samples[k].gyro.y(), watched.samples[2003].gyro.y());
    } else {
      EXPECT_EQ(watched.samples[k].gyro.y(), samples[k].gyro.y());
    }
    EXPECT_TRUE(watched.samples[k].accel_fault_density_mps2_sqrthz.isZero(0));
  }
  // Over t the noise has the variance sigma^2 t^2 of a constant error; the axis is a cosine of one rad/s.
  double variance = 0;
  for (std::size_t k = 2000; k < 2200; ++k) {
    const Eigen::Vector3d& densities = watched.samples[k].gyro_fault_density_radps_sqrthz;
    EXPECT_EQ(densities.x() + densities.z(), 0) << k;
    variance += std::pow(densities.y(), 2) / kRateHz;
  }
  EXPECT_NEAR(variance, 0.5, 0.2 * variance);
}

TEST(ImuAxisWatchTest, AnAxisAtTheEndOfItsRangeIsReportedOnceAndFoundAtOnceAfterwards) {
  std::vector<ImuSample> samples = Motion(4000, 1e-3);
  std::size_t clipped = 0;
  std::vector<bool> saturated(samples.size(), false);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    saturated[k] = samples[k].gyro.x() > 0.7;
    samples[k].gyro.x() = std::min(samples[k].gyro.x(), 0.7);
    clipped += saturated[k] ? 1 : 0;
  }
  ASSERT_GT(clipped, 800u);
  const Watched watched = Watch(samples);
  ASSERT_EQ(watched.reported.size(), 1u);
  EXPECT_THAT(watched.reported[0], HasSubstr("the gyroscope's x axis is saturated at 0.7 rad/s"));
  std::size_t noisy = 0;  // the density rises from zero at the first sample of each saturation
  for (std::size_t k = 800; k < samples.size(); ++k) {
    EXPECT_TRUE(watched.faulty[k] || !saturated[k]) << k;
    EXPECT_TRUE(!watched.faulty[k] || samples[k].gyro.x() == 0.7) << k;
    const Eigen::Vector3d& densities = watched.samples[k].gyro_fault_density_radps_sqrthz;
    EXPECT_EQ(densities.minCoeff(), densities.maxCoeff()) << k;
    EXPECT_TRUE(watched.faulty[k] || densities.isZero(0)) << k;
    noisy += densities.x() > 0 ? 1 : 0;
  }
  EXPECT_GT(noisy, clipped / 2);
}

TEST(ImuAxisWatchTest, AFaultThatReturnsLaterIsReportedAgain) {
  std::vector<ImuSample> samples = Motion(8000, 1e-9);
  for (const std::size_t from : {2000u, 2200u, 6000u}) {
    for (std::size_t k = from; k < from + 100; ++k) {
      samples[k].accel.z() = samples[from].accel.z();
    }
  }
  const Watched watched = Watch(std::move(samples));
  ASSERT_EQ(watched.reported.size(), 2u);
  EXPECT_THAT(watched.reported[1], HasSubstr("the accelerometer's z axis"));
  EXPECT_THAT(watched.reported[1], HasSubstr("from 30.0"));
}

}  // namespace
}  // namespace alidade::test
