#pragma once

#include "gnss/alignment/alignment.h"
#include "tests/support/scenario.h"

namespace alidade::test {

/// An alignment that leaves the world where it is.
inline GnssAlignment IdentityAlignment(TimeNs stamp_ns) {
  GnssAlignment alignment;
  alignment.stamp_ns = stamp_ns;
  alignment.covariance = 1e-12 * Eigen::Matrix4d::Identity();
  return alignment;
}

/// A figure-8 with position fixes between the frames.
inline SimulatorConfig FixScene() {
  SimulatorConfig config;
  config.duration_s = 30;
  config.length_m = 60;
  config.width_m = 30;
  config.path_m = 90;
  config.max_features = 60;
  config.fix.rate_hz = 2;
  config.fix.std_m = 0.2;
  config.fix.time_offset_s = 0.033;
  return config;
}

/// Runs the sequence with an estimator that stands in the frame of the fixes from the start; `after` sees it
/// after each fix, which is in IMU time.
template <typename After>
void RunWithFixes(const Dataset& dataset, const NavEstimate& initial, Estimator* estimator,
                  const After& after) {
  ASSERT_TRUE(estimator->Initialize(initial).ok());
  ASSERT_TRUE(estimator->Align(IdentityAlignment(dataset.imu.front().stamp_ns)).ok());
  std::size_t imu = 0;
  std::size_t next = 0;
  const auto deliver = [&](TimeNs stamp_ns) {
    for (; imu < dataset.imu.size() && (imu == 0 || dataset.imu[imu - 1].stamp_ns < stamp_ns); ++imu) {
      ASSERT_TRUE(estimator->AddImu(dataset.imu[imu]).ok());
    }
  };
  for (const TrackFrame& frame : dataset.frames) {
    for (; next < dataset.fixes.size(); ++next) {
      PositionFix fix = dataset.fixes[next];
      fix.stamp_ns += SecondsToNs(dataset.rig.fixes[0].time_offset_s);
      if (fix.stamp_ns >= frame.stamp_ns) {
        break;
      }
      deliver(fix.stamp_ns);
      const Status status = estimator->AddMeasurement(fix);
      ASSERT_TRUE(status.ok()) << status.message();
      after(fix);
    }
    deliver(frame.stamp_ns);
    const Status status = estimator->AddFrame(frame);
    ASSERT_TRUE(status.ok()) << status.message();
  }
}

}  // namespace alidade::test
