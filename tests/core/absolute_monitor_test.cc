#include "core/absolute_monitor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDriftM = 0.01;    ///< of vision and IMU between two measurements, each axis
constexpr double kMeasuredM = 0.7;  ///< deviation of a measured position
constexpr double kPeriodS = 0.1;

/// A scalar Kalman filter of a random walk for each axis, the estimate of which follows measurements of the
/// position zero with these errors.
class Follower {
 public:
  AbsoluteComparison Measure(const Vector3d& error) {
    variance_ += kDriftM * kDriftM;
    const double gain = variance_ / (variance_ + kMeasuredM * kMeasuredM);
    stamp_ns_ += SecondsToNs(kPeriodS);
    AbsoluteComparison comparison;
    comparison.stamp_ns = stamp_ns_;
    comparison.change = gain * (error - position_);
    comparison.change_covariance = gain * variance_ * Matrix3d::Identity();
    position_ += comparison.change;
    variance_ *= 1 - gain;
    comparison.left = error - position_;
    comparison.left_covariance = kMeasuredM * kMeasuredM * Matrix3d::Identity();
    return comparison;
  }
  void Drift(RandomStream* random) { position_ += kDriftM * random->Normal3(); }

 private:
  TimeNs stamp_ns_ = 0;
  Vector3d position_ = Vector3d::Zero();
  double variance_ = 1;
};

// GIVEN noise as stated, white or of first order with 30 s, THEN nothing is reported in an hour of 10 Hz.
TEST(AbsoluteMonitorTest, IsSilentWhereNoiseIsAsStatedEvenIfItLasts) {
  for (const double time_s : {0.0, 30.0}) {
    RandomStream random(3, "noise");
    Follower follower;
    AbsoluteMonitor monitor;
    Vector3d error = kMeasuredM * random.Normal3();
    const double kept = time_s > 0 ? std::exp(-kPeriodS / time_s) : 0;
    for (int i = 0; i < 36000; ++i) {
      error = kept * error + kMeasuredM * std::sqrt(1 - kept * kept) * random.Normal3();
      follower.Drift(&random);
      monitor.Add(follower.Measure(error));
      ASSERT_FALSE(monitor.contradiction()) << i << " of " << time_s;
    }
  }
}

// GIVEN positions that are pulled off at 0.5 m/s, THEN it is reported before 10 m, with the distance as far
// as the window reaches.
TEST(AbsoluteMonitorTest, DetectsAPull) {
  RandomStream random(4, "noise");
  Follower follower;
  AbsoluteMonitor monitor;
  for (int i = 0; i < 600; ++i) {
    follower.Drift(&random);
    monitor.Add(follower.Measure(kMeasuredM * random.Normal3()));
  }
  EXPECT_FALSE(monitor.contradiction());
  double pull_m = 0;
  for (; pull_m < 15 && !monitor.contradiction(); pull_m += 0.5 * kPeriodS) {
    follower.Drift(&random);
    monitor.Add(follower.Measure(Vector3d(pull_m, 0, 0) + kMeasuredM * random.Normal3()));
  }
  ASSERT_TRUE(monitor.contradiction());
  EXPECT_LT(pull_m, 10);
  EXPECT_GT(monitor.contradiction()->sigmas, AbsoluteMonitor::kMaxSigmas);
  EXPECT_NEAR(monitor.contradiction()->distance_m, pull_m, 3);
}

// GIVEN wrong measurements that are refused, so that nothing changes, THEN three in a row are not reported,
// ten seconds of them are.
TEST(AbsoluteMonitorTest, SingleWrongOnesAreNoPull) {
  AbsoluteMonitor monitor;
  const auto add = [&](int second, double left_m) {
    AbsoluteComparison comparison;
    comparison.stamp_ns = SecondsToNs(second);
    comparison.left = Vector3d(0, left_m, 0);
    monitor.Add(comparison);
  };
  for (int i = 0; i < 20; ++i) {
    add(i, i % 5 < 3 ? 40 : 0);
    ASSERT_FALSE(monitor.contradiction()) << i;
  }
  for (int i = 20; i < 30; ++i) {
    add(i, 40);
  }
  EXPECT_TRUE(monitor.contradiction());
}

}  // namespace
}  // namespace alidade
