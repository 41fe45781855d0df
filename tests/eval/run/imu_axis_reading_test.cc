#include <gtest/gtest.h>

#include <algorithm>

#include "core/lie.h"
#include "tests/eval/run/watched_axes.h"

// What an axis that does not measure is taken to read.

namespace alidade::test {
namespace {

using Eigen::Vector3d;

/// Estimates 0.1 s apart that imply this rate [rad/s] of the y axis from `end_s` on for a second.
ImpliedImu Implying(double rate, double end_s) {
  ImpliedImu implied(9.81);
  NavEstimate estimate;
  estimate.stamp_ns = SecondsToNs(end_s - 0.1);
  implied.Add(estimate);
  estimate.stamp_ns = SecondsToNs(end_s);
  estimate.nav.R_WB = so3::Exp(Vector3d(0, 0.1 * rate, 0));
  implied.Add(estimate);
  return implied;
}

// GIVEN what the motion implies for an axis that sticks THEN the axis reads that while it counts, afterwards
// its mean.
TEST(ImuAxisWatchTest, AStuckAxisReadsWhatTheMotionImplies) {
  std::vector<ImuSample> samples = Motion(4000, 1e-9);
  for (std::size_t k = 2000; k < 3000; ++k) {
    samples[k].gyro.y() = samples[1999].gyro.y();
  }
  const ImpliedImu implied = Implying(0.7, 11);
  const Watched watched = Watch(samples, &implied);
  for (const std::size_t k : {2018u, 2200u, 2400u}) {
    EXPECT_NEAR(watched.samples[k].gyro.y(), 0.7, 1e-9) << k;
  }
  EXPECT_LT(std::abs(watched.samples[2402].gyro.y()), 0.25);
  EXPECT_EQ(watched.samples[3000].gyro.y(), samples[3000].gyro.y());
}

// GIVEN a clipped axis THEN it reads what the motion implies beyond the limit, and its own value where that
// is less.
TEST(ImuAxisWatchTest, ASaturatedAxisReadsWhatTheMotionImpliesBeyondItsRange) {
  std::vector<ImuSample> samples = Motion(4000, 1e-9);
  for (ImuSample& sample : samples) {
    sample.gyro.y() = std::clamp(sample.gyro.y(), -0.6, 0.6);
  }
  for (const double rate : {0.8, 2.0, 0.3, -0.8}) {
    const ImpliedImu implied = Implying(rate, 3600);
    const Watched watched = Watch(samples, &implied);
    const double above = std::max(rate, 0.6);
    const double below = std::min(rate, -0.6);
    int saturated = 0;
    for (std::size_t k = 2000; k < samples.size(); ++k) {
      if (watched.faulty[k]) {
        ++saturated;
        ASSERT_NEAR(watched.samples[k].gyro.y(), samples[k].gyro.y() > 0 ? above : below, 1e-9) << k;
      } else {
        ASSERT_EQ(watched.samples[k].gyro.y(), samples[k].gyro.y()) << k;
      }
    }
    EXPECT_GT(saturated, 500);
  }
}

}  // namespace
}  // namespace alidade::test
