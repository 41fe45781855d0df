#include "eval/calibrate/gyro_correlation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/eval/calibrate/shaken_camera.h"

namespace alidade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

GyroCorrelation Correlate(const MeasurementLog& log) {
  const LogTables tables = TablesOf(log);
  return CorrelateGyro(TurnsOfImages(log.rig.camera, tables.frames), tables.imu,
                       log.rig.camera_time_offset_s);
}

TEST(GyroCorrelationTest, TurnsOfImagesAreAboutThoseOfTheGyroscope) {
  const MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
  const GyroCorrelation rates = Correlate(log);
  EXPECT_TRUE(rates.agree());
  EXPECT_FALSE(rates.clocks_differ());
  EXPECT_NEAR(rates.best.lag_s, 0, 0.05);
  EXPECT_NEAR(rates.best.scale, 1, 0.3);
}

// The lag is what is missing from the sheet's time offset, whatever T_BS is.
TEST(GyroCorrelationTest, ALagOfSecondsIsFoundWithWrongAxesToo) {
  MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
  log.rig.T_BC.rotation.setIdentity();
  for (TrackFrame& frame : log.frames) {
    frame.stamp_ns += SecondsToNs(4);
  }
  log.rig.camera_time_offset_s = -1;
  const GyroCorrelation rates = Correlate(log);
  EXPECT_TRUE(rates.clocks_differ());
  EXPECT_NEAR(rates.best.lag_s, -3, 0.05);
  log.rig.camera_time_offset_s = -4;
  EXPECT_FALSE(Correlate(log).clocks_differ());
}

// GIVEN a motion that repeats itself every two seconds WHEN the camera is a second late THEN no lag is
// distinct, and none is claimed.
TEST(GyroCorrelationTest, APeriodicMotionHasNoDistinctLag) {
  std::vector<ImageTurn> turns;
  for (int k = 0; k < 200; ++k) {
    const TimeNs i_ns = 100 * kSecondNs + k * (kSecondNs / 10);
    const double t_s = 0.1 * k - 1;
    turns.push_back({i_ns, i_ns + kSecondNs / 10, {0.5 + 0.4 * std::sin(M_PI * (t_s + 0.05)), 0, 0}});
  }
  std::vector<ImuSample> imu;
  for (int k = 0; k <= 4000; ++k) {
    ImuSample sample;
    sample.stamp_ns = 95 * kSecondNs + k * (kSecondNs / 100);
    sample.gyro.x() = 0.5 + 0.4 * std::sin(M_PI * (0.01 * k - 5));
    imu.push_back(sample);
  }
  const GyroCorrelation rates = CorrelateGyro(turns, Table<ImuSample>(imu), 0);
  EXPECT_TRUE(rates.agree());
  EXPECT_FALSE(rates.clocks_differ());
}

/// A smooth motion of `duration_s` by a camera four seconds early, and a gyroscope from long before to long
/// after it.
GyroCorrelation OfSmoothMotion(double duration_s) {
  const auto rate = [](double t_s) {
    return 1 + 0.2 * (std::sin(1.1 * t_s) + std::sin(1.9 * t_s) + std::sin(3.1 * t_s));
  };
  std::vector<ImageTurn> turns;
  for (int k = 0; k < static_cast<int>(10 * duration_s); ++k) {
    const TimeNs i_ns = 100 * kSecondNs + k * (kSecondNs / 10);
    turns.push_back({i_ns, i_ns + kSecondNs / 10, {rate(0.1 * k + 0.05), 0, 0}});
  }
  std::vector<ImuSample> imu;
  for (int k = -1500; k <= 1500 + static_cast<int>(100 * duration_s); ++k) {
    ImuSample sample;
    sample.stamp_ns = 104 * kSecondNs + k * (kSecondNs / 100);
    sample.gyro.x() = rate(0.01 * k);
    imu.push_back(sample);
  }
  return CorrelateGyro(turns, Table<ImuSample>(imu), 0);
}

// GIVEN a smooth motion of a few seconds THEN a lag of seconds, which may be chance, is not claimed, and
// below half a minute not as certain.
TEST(GyroCorrelationTest, ALagOfSecondsNeedsTime) {
  EXPECT_FALSE(OfSmoothMotion(12).clocks_differ());
  EXPECT_GT(OfSmoothMotion(12).near.turns, 0U);
  const GyroCorrelation some = OfSmoothMotion(20);
  EXPECT_TRUE(some.clocks_differ());
  EXPECT_FALSE(some.certain());
  const GyroCorrelation long_enough = OfSmoothMotion(40);
  EXPECT_TRUE(long_enough.clocks_differ());
  EXPECT_TRUE(long_enough.certain());
  EXPECT_NEAR(long_enough.best.lag_s, 4, 0.01);
}

TEST(GyroCorrelationTest, WithoutAnotherLagToCompareNoneIsDistinct) {
  GyroCorrelation rates;
  rates.best = {.lag_s = 2, .correlation = 0.99, .scale = 1, .span_s = 40, .turns = 400};
  rates.near = {.lag_s = 0, .correlation = 0.1, .scale = 1, .span_s = 40, .turns = 400};
  EXPECT_FALSE(rates.clocks_differ());
  rates.other = rates.near;
  EXPECT_TRUE(rates.clocks_differ());
}

TEST(GyroCorrelationTest, AnOffsetThatNoSheetTakesIsToBeAddedToTheStamps) {
  GyroCorrelation rates;
  rates.best.lag_s = -4;
  EXPECT_THAT(DescribeClocks(rates, -6), HasSubstr("expected time_offset_s: -10.00 in its sheet"));
  EXPECT_THAT(DescribeClocks(rates, -8),
              AllOf(HasSubstr("shift the stamps by -4.00 s"), Not(HasSubstr("expected time_offset_s"))));
}

TEST(GyroCorrelationTest, WithoutTracksOrImuNothingAgrees) {
  EXPECT_FALSE(Correlate(MeasurementLog()).agree());
  MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
  log.imu.clear();
  EXPECT_FALSE(Correlate(log).agree());
}

}  // namespace
}  // namespace alidade::test
