#include <gtest/gtest.h>

#include "eval/simulation/simulator.h"
#include "tests/eval/record/gnss_scene.h"
#include "tests/support/scenario.h"

// Runs whose receiver's clock is not that of the IMU.

namespace alidade::test {
namespace {

constexpr unsigned kSeed = 5;

/// 25 s of a figure-8 at 4 m/s with GNSS and camera.
Dataset Flight() {
  SimulatorConfig config = GnssScene(25);
  config.gnss.rate_hz = 5;
  return SimulateOrDie(config, kSeed);
}

/// The same with IMU and camera on a clock that is behind by `shift_s`, as a sheet with t_imu = t_GPST - 18 s
/// has them on UTC.
Dataset ClocksBehind(Dataset dataset, double shift_s) {
  const TimeNs shift_ns = SecondsToNs(shift_s);
  for (ImuSample& sample : dataset.imu) {
    sample.stamp_ns -= shift_ns;
  }
  for (TrackFrame& frame : dataset.frames) {
    frame.stamp_ns -= shift_ns;
  }
  for (TrajectoryPoint& point : dataset.truth->points) {
    point.stamp_ns -= shift_ns;
  }
  dataset.rig.gnss.time_offset_s -= shift_s;
  return dataset;
}

RunResult RunWithGnss(const Dataset& dataset) {
  return RunWithSensors(GnssEstimator(Backend::kFilter), dataset, kSeed);
}

// GIVEN a receiver whose tags are 18 s ahead of the IMU's time, as in the sheet, THEN its epochs come
// before their frames all the same, and the run is that of equal clocks.
TEST(GnssOffsetRun, EpochsOfAClockThatIsFarAheadAreUsed) {
  const Dataset together = Flight();
  const RunResult expected = RunWithGnss(together);
  ASSERT_TRUE(expected.status.ok()) << expected.status.message();
  ASSERT_TRUE(expected.global.has_value()) << expected.align_report;
  ASSERT_GT(expected.epochs_used, 0);
  for (const double shift_s : {18.0, -18.0}) {
    const RunResult result = RunWithGnss(ClocksBehind(together, shift_s));
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    ASSERT_TRUE(result.global.has_value()) << shift_s << ": " << result.align_report;
    EXPECT_EQ(result.epochs_used, expected.epochs_used);
    EXPECT_EQ(result.skipped[Sensor::kGnss], expected.skipped[Sensor::kGnss]) << result.skip_report;
    EXPECT_EQ(result.global->stamp_ns, expected.global->stamp_ns - SecondsToNs(shift_s));
    EXPECT_NEAR(result.global->yaw_rad, expected.global->yaw_rad, 1e-6);
    ASSERT_EQ(result.records.size(), expected.records.size());
    EXPECT_LT((result.records.back().estimate.nav.p_WB - expected.records.back().estimate.nav.p_WB).norm(),
              1e-6);
  }
}

}  // namespace
}  // namespace alidade::test
