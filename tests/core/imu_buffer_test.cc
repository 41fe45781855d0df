#include "core/imu_buffer.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alidade {
namespace {

using Eigen::Vector3d;

ImuSample At(double seconds, double value) {
  return {SecondsToNs(seconds), Vector3d::Constant(value), Vector3d::Constant(-value)};
}

TEST(ImuBufferTest, SortsAndDropsDuplicates) {
  ImuBuffer buffer(0.5);
  for (const double t : {0.0, 0.02, 0.01, 0.02, 0.03}) {
    EXPECT_TRUE(buffer.Add(At(t, t)).ok());
  }
  ASSERT_EQ(buffer.samples().size(), 4u);
  EXPECT_EQ(buffer.samples()[1].stamp_ns, SecondsToNs(0.01));
  EXPECT_EQ(buffer.statistics().out_of_order, 1);
  EXPECT_EQ(buffer.statistics().duplicates, 1);
}

TEST(ImuBufferTest, InterpolatesToTheMeasurement) {
  ImuBuffer buffer(0.5);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(buffer.Add(At(0.01 * i, i)).ok());
  }
  std::vector<ImuSample> samples;
  ASSERT_TRUE(buffer.Interval(SecondsToNs(0.005), SecondsToNs(0.0325), &samples).ok());
  ASSERT_EQ(samples.size(), 5u);
  EXPECT_NEAR(samples.front().gyro.x(), 0.5, 1e-12);
  EXPECT_NEAR(samples.back().accel.x(), -3.25, 1e-9);
  EXPECT_EQ(samples.back().stamp_ns, SecondsToNs(0.0325));
  ASSERT_TRUE(buffer.Interval(SecondsToNs(0.01), SecondsToNs(0.03), &samples).ok());
  EXPECT_EQ(samples.size(), 3u) << "ends that are measured are not doubled";
}

// GIVEN readings on a parabola THEN the ends lie on it, and measured samples show its curvature where there
// are two before them.
TEST(ImuBufferTest, AnIntervalFollowsAParabola) {
  const auto value = [](double t_s) { return 3 + 2 * t_s - 50 * t_s * t_s; };
  ImuBuffer buffer(0.5);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(buffer.Add(At(0.01 * i, value(0.01 * i))).ok());
  }
  std::vector<ImuSample> samples;
  ASSERT_TRUE(buffer.Interval(SecondsToNs(0.0), SecondsToNs(0.03), &samples).ok());
  EXPECT_EQ(samples[1].gyro_curvature, Vector3d::Zero());
  EXPECT_NEAR(samples[2].gyro_curvature.x(), -100, 1e-9);
  EXPECT_NEAR(samples[3].accel_curvature.y(), 100, 1e-9);
  buffer.DropBefore(SecondsToNs(0.034));
  ASSERT_TRUE(buffer.Interval(SecondsToNs(0.034), SecondsToNs(0.067), &samples).ok());
  ASSERT_EQ(samples.size(), 5u);
  for (const ImuSample& sample : samples) {
    EXPECT_NEAR(sample.gyro.z(), value(SecondsBetween(0, sample.stamp_ns)), 1e-12);
    EXPECT_NEAR(sample.gyro_curvature.x(), -100, 1e-9);
  }
}

// GIVEN a start after a loss THEN samples of before are forgotten, and those around the start are taken
// whatever was consumed.
TEST(ImuBufferTest, AStartAfterALossBeginsAnew) {
  ImuBuffer buffer(0.5);
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(buffer.Add(At(0.01 * i, 1)).ok());
  }
  buffer.DropBefore(SecondsToNs(0.09));
  buffer.StartAt(SecondsToNs(5.005));
  EXPECT_TRUE(buffer.samples().empty());
  for (const double stamp_s : {4.99, 5.0, 5.01}) {
    EXPECT_TRUE(buffer.Add(At(stamp_s, 2)).ok()) << stamp_s;
  }
  std::vector<ImuSample> samples;
  ASSERT_TRUE(buffer.Interval(SecondsToNs(5.005), SecondsToNs(5.01), &samples).ok());
  EXPECT_EQ(samples.front().gyro.x(), 2);
  buffer.StartAt(SecondsToNs(5.02));
  EXPECT_EQ(buffer.samples().size(), 2u) << "a start directly behind needs the last samples";
}

TEST(ImuBufferTest, ReportsWhatIsMissing) {
  ImuBuffer buffer(0.05);
  std::vector<ImuSample> samples;
  EXPECT_FALSE(buffer.Interval(0, 10, &samples).ok());
  ASSERT_TRUE(buffer.Add(At(1.0, 1)).ok());
  ASSERT_TRUE(buffer.Add(At(1.2, 1)).ok());
  EXPECT_NE(buffer.Interval(SecondsToNs(1.1), SecondsToNs(1.3), &samples).message().find("missing 100.0"),
            std::string::npos);
  EXPECT_NE(buffer.Interval(SecondsToNs(0.9), SecondsToNs(1.1), &samples).message().find("starts 100.0"),
            std::string::npos);
  EXPECT_FALSE(buffer.Interval(SecondsToNs(1.1), SecondsToNs(1.1), &samples).ok());
  ASSERT_TRUE(buffer.Interval(SecondsToNs(1.0), SecondsToNs(1.2), &samples).ok());
  EXPECT_EQ(buffer.statistics().gaps, 1);
  EXPECT_NEAR(buffer.statistics().longest_gap_s, 0.2, 1e-9);
}

TEST(ImuBufferTest, RefusesWhatIsNotFiniteOrTooOld) {
  ImuBuffer buffer(0.5);
  EXPECT_FALSE(buffer.Add({0, Vector3d(std::nan(""), 0, 0), Vector3d::Zero()}).ok());
  for (const double stamp_s : {0.9, 1.0, 1.1, 1.2}) {
    ASSERT_TRUE(buffer.Add(At(stamp_s, 1)).ok());
  }
  buffer.DropBefore(SecondsToNs(1.15));
  EXPECT_EQ(buffer.samples().size(), 3u) << "two samples before the stamp are needed to interpolate";
  EXPECT_FALSE(buffer.Add(At(1.05, 1)).ok());
  EXPECT_EQ(buffer.statistics().rejected, 2);
}

TEST(ImuBufferTest, RefusesMagnitudesBeyondAnySensor) {
  ImuBuffer buffer(0.5);
  const Vector3d gravity(0, 0, 9.81);
  EXPECT_EQ(buffer.Add({0, Vector3d::Zero(), Vector3d(0, 1e200, 0)}).code(), StatusCode::kInput);
  const Status status = buffer.Add({0, Vector3d(1e7, 0, 0), gravity});
  EXPECT_NE(status.message().find("measures 1e+07 rad/s"), std::string::npos) << status.message();
  EXPECT_TRUE(buffer.Add({0, Vector3d(70, 0, 0), 200 * gravity}).ok()) << "fast, but within a sensor's range";
  EXPECT_EQ(buffer.statistics().rejected, 2);
}

TEST(ImuBufferTest, AnEmptyBufferThatDropsStillTakesTheSampleBeforeTheStamp) {
  // An estimator that starts between two samples gets its stamp first and gets the samples afterwards.
  ImuBuffer buffer(0.5);
  buffer.DropBefore(SecondsToNs(1.15));
  EXPECT_TRUE(buffer.Add(At(1.1, 1)).ok());
  EXPECT_TRUE(buffer.Add(At(1.2, 1)).ok());
  std::vector<ImuSample> samples;
  EXPECT_TRUE(buffer.Interval(SecondsToNs(1.15), SecondsToNs(1.2), &samples).ok());
  buffer.DropBefore(SecondsToNs(1.15));
  EXPECT_FALSE(buffer.Add(At(1.12, 1)).ok());
}

}  // namespace
}  // namespace alidade
