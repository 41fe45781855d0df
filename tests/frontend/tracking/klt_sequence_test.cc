// What a KltTracker makes of the sequence of its images and samples, whatever they show.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "frontend/tracking/klt_tracker.h"
#include "tests/frontend/tracking/synthetic_scene.h"
#include "tests/frontend/tracking/track_images.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::FeedRotation;
using test::kFrameNs;
using test::kHeightPx;
using test::kWidthPx;
using test::MustTrack;
using test::TestRig;
using test::Wall;

// GIVEN a camera that hands out an image twice while the body turns on, WHEN the next image comes, THEN the
// repeated one showed every track on its very pixel, and none is lost for the rotation meanwhile.
TEST(KltSequence, ARepeatedImageLeavesEveryTrackWhereItWas) {
  const RigCalibration rig = TestRig(376, 240);
  const Wall wall(rig.camera, 2.0);
  KltTracker tracker({}, rig);
  const Matrix3d R_step = so3::Exp({0.01, -0.03, 0.01});
  Pose T_WC;
  std::vector<TrackFrame> frames;
  std::vector<unsigned char> image;
  for (int k = 0; k < 6; ++k) {
    const bool repeats = k == 3 || k == 4;
    image = repeats ? image : wall.Image(T_WC);
    frames.push_back(MustTrack(&tracker, k * kFrameNs, image, 376, 240));
    if (repeats) {
      const TrackFrame& before = frames[frames.size() - 2];
      ASSERT_EQ(frames.back().observations.size(), before.observations.size());
      for (size_t i = 0; i < before.observations.size(); ++i) {
        EXPECT_EQ(frames.back().observations[i].track_id, before.observations[i].track_id);
        EXPECT_EQ(frames.back().observations[i].pixel, before.observations[i].pixel);
      }
      EXPECT_EQ(tracker.statistics().tracked, static_cast<int>(before.observations.size()));
    }
    FeedRotation(&tracker, rig, R_step, k * kFrameNs);
    T_WC.rotation = T_WC.rotation * R_step;
  }
  EXPECT_GT(tracker.statistics().tracked, 0.6 * static_cast<double>(frames[2].observations.size()));
}

TEST(KltSequence, TwoTrackersGiveTheSameBytesWhateverRunsBetween) {
  const RigCalibration rig = TestRig(376, 240);
  const Wall wall(rig.camera, 2.0);
  KltTracker alone({}, rig);
  KltTracker beside({}, rig);
  KltTracker disturber({}, rig);
  std::vector<TrackFrame> frames;
  std::vector<std::vector<unsigned char>> images;
  const Matrix3d R_step = so3::Exp({0.01, -0.02, 0.01});
  Pose T_WC;
  for (int k = 0; k < 5; ++k) {
    images.push_back(wall.Image(T_WC));
    frames.push_back(MustTrack(&alone, k * kFrameNs, images.back(), 376, 240));
    FeedRotation(&alone, rig, R_step, k * kFrameNs);
    T_WC.rotation = T_WC.rotation * R_step;
    T_WC.translation += Vector3d(0.02, 0, 0);
  }
  for (int k = 0; k < 5; ++k) {
    MustTrack(&disturber, k * kFrameNs, images[static_cast<size_t>(4 - k)], 376, 240);
    const TrackFrame frame = MustTrack(&beside, k * kFrameNs, images[static_cast<size_t>(k)], 376, 240);
    FeedRotation(&beside, rig, R_step, k * kFrameNs);
    const TrackFrame& expected = frames[static_cast<size_t>(k)];
    ASSERT_EQ(frame.observations.size(), expected.observations.size()) << "frame " << k;
    for (size_t i = 0; i < frame.observations.size(); ++i) {
      EXPECT_EQ(frame.observations[i].track_id, expected.observations[i].track_id);
      EXPECT_EQ(frame.observations[i].pixel, expected.observations[i].pixel);
    }
  }
}

TEST(KltSequence, RefusesWrongSizesAndStampsThatDoNotIncrease) {
  KltTracker tracker({}, TestRig());
  const std::vector<unsigned char> image(kWidthPx * kHeightPx, 7);
  const Result<TrackFrame> narrow = tracker.Track(0, image.data(), 640, kHeightPx);
  EXPECT_EQ(narrow.code(), StatusCode::kInput);
  EXPECT_THAT(narrow.message(), testing::HasSubstr("640 x 480, expected the camera's 752 x 480"));
  EXPECT_EQ(tracker.Track(0, nullptr, kWidthPx, kHeightPx).code(), StatusCode::kInput);
  MustTrack(&tracker, 1000, image);
  const Result<TrackFrame> repeated = tracker.Track(1000, image.data(), kWidthPx, kHeightPx);
  EXPECT_EQ(repeated.code(), StatusCode::kInput);
  EXPECT_THAT(repeated.message(), testing::HasSubstr("1000 ns"));
  EXPECT_FALSE(tracker.Track(999, image.data(), kWidthPx, kHeightPx).ok());
  MustTrack(&tracker, 1001, image);
}

TEST(KltSequence, CountsImuSamplesItCannotUse) {
  KltTracker tracker({}, TestRig());
  tracker.AddImu({.stamp_ns = 10, .gyro = Vector3d::Zero(), .accel = Vector3d::Zero()});
  tracker.AddImu({.stamp_ns = 10, .gyro = Vector3d::Zero(), .accel = Vector3d::Zero()});
  tracker.AddImu({.stamp_ns = 20, .gyro = Vector3d(0, std::nan(""), 0), .accel = Vector3d::Zero()});
  EXPECT_EQ(tracker.statistics().imu_ignored, 2);
}

}  // namespace
}  // namespace alidade
