#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "frontend/tracking/klt_tracker.h"

namespace alidade::test {

inline constexpr int kWidthPx = 752;
inline constexpr int kHeightPx = 480;
inline constexpr TimeNs kFrameNs = 50'000'000;

inline FrontendConfig WithoutImu() {
  FrontendConfig config;
  config.imu_prediction = false;
  return config;
}

/// Tracks an image that must be accepted.
inline TrackFrame MustTrack(KltTracker* tracker, TimeNs stamp_ns, const std::vector<unsigned char>& image,
                            int width_px = kWidthPx, int height_px = kHeightPx) {
  Result<TrackFrame> frame = tracker->Track(stamp_ns, image.data(), width_px, height_px);
  EXPECT_TRUE(frame.ok()) << frame.message();
  return frame.ok() ? *frame : TrackFrame{};
}

/// Gyroscope samples at 200 Hz of the constant body rate that turns the camera by C0_rotation_C1 in one
/// frame.
inline void FeedRotation(KltTracker* tracker, const RigCalibration& rig, const Eigen::Matrix3d& R_C0C1,
                         TimeNs from_ns) {
  const Eigen::Vector3d rate = rig.T_BC.rotation * so3::Log(R_C0C1) / (kFrameNs * kNsToSeconds);
  for (int i = 0; i < 10; ++i) {
    tracker->AddImu(
        {.stamp_ns = from_ns + i * kFrameNs / 10, .gyro = rate, .accel = Eigen::Vector3d::Zero()});
  }
}

}  // namespace alidade::test
