#include "eval/calibrate/gyro_correlation.h"

#include <gtest/gtest.h>

#include "tests/eval/calibrate/shaken_camera.h"

namespace alidade::test {
namespace {

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

// The lag is what is missing from the sheet's time offset, whatever T_BS says.
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

TEST(GyroCorrelationTest, WithoutTracksOrImuNothingAgrees) {
  EXPECT_FALSE(Correlate(MeasurementLog()).agree());
  MeasurementLog log = ShakenCamera{PhoneModel()}.Record();
  log.imu.clear();
  EXPECT_FALSE(Correlate(log).agree());
}

}  // namespace
}  // namespace alidade::test
