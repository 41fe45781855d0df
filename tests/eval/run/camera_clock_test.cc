#include "eval/run/camera_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "eval/simulation/simulator.h"

namespace alidade {
namespace {

/// Feeds frames to the clock as a session does: a jump that is reported is taken off the stamps.
class CameraClockTest : public testing::Test {
 protected:
  CameraClockTest() {
    SimulatorConfig config;
    config.duration_s = 12;
    config.path_m = 15;
    config.wobble_rad = 0.2;
    dataset_ = *Simulate(config, 733);
  }

  /// Jumps reported, of a camera whose stamps are late by late_s(frame index, jumps reported so far).
  template <typename Late>
  std::vector<double> Jumps(const Late& late_s) {
    CameraClock clock(dataset_.rig, 1);
    for (const ImuSample& sample : dataset_.imu) {
      clock.AddImu(sample);
    }
    std::vector<double> reported;
    TimeNs taken_off_ns = 0;
    for (size_t i = 0; i + 40 < dataset_.frames.size(); ++i) {
      TrackFrame frame = dataset_.frames[i];
      frame.stamp_ns += SecondsToNs(late_s(i, reported.size()));
      if (const auto jump = clock.FindJump(frame, frame.stamp_ns - taken_off_ns, Eigen::Vector3d::Zero())) {
        taken_off_ns += *jump;
        reported.push_back(SecondsBetween(0, *jump));
      }
    }
    return reported;
  }

  Dataset dataset_;
};

TEST_F(CameraClockTest, FindsTwoJumpsOfFollowingFrames) {
  size_t second = 1000;
  const std::vector<double> reported = Jumps([&](size_t i, size_t jumps) {
    if (jumps == 1 && second == 1000) {
      second = i;
    }
    return (i >= 30 ? 0.8 : 0) + (i >= second ? 0.6 : 0);
  });
  ASSERT_EQ(reported.size(), 2U);
  EXPECT_NEAR(reported[0], 0.8, 1e-6);
  EXPECT_NEAR(reported[1], 0.6, 1e-6);
}

TEST_F(CameraClockTest, StampsThatHoldAreLeftAlone) {
  EXPECT_TRUE(Jumps([](size_t, size_t) { return 0.0; }).empty());
}

TEST_F(CameraClockTest, ASilenceOfTheCameraIsNoJump) {
  dataset_.frames.erase(dataset_.frames.begin() + 30, dataset_.frames.begin() + 38);
  EXPECT_TRUE(Jumps([](size_t, size_t) { return 0.0; }).empty());
}

}  // namespace
}  // namespace alidade
