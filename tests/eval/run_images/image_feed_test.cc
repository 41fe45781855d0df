#include "eval/run_images/image_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/frontend/tracking/synthetic_scene.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr TimeNs kFrameNs = 50'000'000;
constexpr TimeNs kStartNs = 1'000'000'000;

/// A texture that drifts by two pixels an image.
GreyImage ImageAt(const RigCalibration& rig, int index) {
  GreyImage image{rig.camera.width_px(), rig.camera.height_px(), {}};
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      image.pixels.push_back(test::Texture(Eigen::Vector2d(x + 2 * index, y)));
    }
  }
  return image;
}

/// Records the frames that the feed hands on.
class Recording final : public Estimator {
 public:
  Status Initialize(const NavEstimate& initial) override {
    latest_ = initial;
    return Status::Ok();
  }
  Status AddImu(const ImuSample&) override { return Status::Ok(); }
  Status AddFrame(const TrackFrame& frame) override {
    frames.push_back(frame);
    return Status::Ok();
  }
  NavEstimate Latest() const override { return latest_; }
  bool initialized() const override { return true; }
  const FrameStatistics& last_statistics() const override { return statistics_; }

  std::vector<TrackFrame> frames;

 private:
  NavEstimate latest_;
  FrameStatistics statistics_;
};

struct Rigged {
  RigCalibration rig = test::TestRig();
  EstimatorConfig config;
  SessionOptions options;
  Recording estimator;

  Rigged() {
    config.init.method = InitMethod::kTruth;
    config.recovery.enabled = false;
    options.lateness = {0.01, 0.1, 0};
    options.start_state = [](TimeNs imu_ns) -> Result<NavEstimate> {
      NavEstimate start;
      start.stamp_ns = imu_ns;
      return start;
    };
  }
};

ImuSample AtRest(TimeNs stamp_ns) {
  return {stamp_ns, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 9.81)};
}

// GIVEN images that come late and swapped, WHEN they go through the feed, THEN the session gets the tracks of
// the ordered images.
TEST(ImageFeedTest, TracksInTheOrderOfStamps) {
  Rigged setup;
  constexpr int kImages = 4;
  std::vector<TrackFrame> expected;
  KltTracker tracker(setup.config.frontend, setup.rig);
  for (int i = 0; i < kImages; ++i) {
    for (TimeNs t = i == 0 ? 0 : -kFrameNs + 5'000'000; t <= 0; t += 5'000'000) {
      tracker.AddImu(AtRest(kStartNs + i * kFrameNs + t));
    }
    const GreyImage image = ImageAt(setup.rig, i);
    Result<TrackFrame> frame =
        tracker.Track(kStartNs + i * kFrameNs, image.pixels.data(), image.width_px, image.height_px);
    ASSERT_TRUE(frame.ok()) << frame.message();
    expected.push_back(*frame);
  }

  Session session(setup.config, setup.rig, setup.options, &setup.estimator);
  ImageFeed feed(setup.config.frontend, setup.rig, setup.options.lateness, &session);
  int added = 0;
  const std::vector<int> order = {1, 0, 3, 2};
  for (TimeNs t = 0; t <= kImages * kFrameNs; t += 5'000'000) {
    ASSERT_TRUE(feed.AddImu(AtRest(kStartNs + t)).ok());
    while (added < kImages && t >= (order[static_cast<size_t>(added)] + 1) * kFrameNs) {
      const int index = order[static_cast<size_t>(added++)];
      ASSERT_TRUE(feed.AddImage(kStartNs + index * kFrameNs, ImageAt(setup.rig, index)).ok());
    }
  }
  while (added < kImages) {
    const int index = order[static_cast<size_t>(added++)];
    ASSERT_TRUE(feed.AddImage(kStartNs + index * kFrameNs, ImageAt(setup.rig, index)).ok());
  }
  ASSERT_TRUE(feed.Flush().ok());
  ASSERT_EQ(setup.estimator.frames.size(), expected.size());
  EXPECT_GT(expected.back().observations.size(), 20u);
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(setup.estimator.frames[i].stamp_ns, expected[i].stamp_ns);
    ASSERT_EQ(setup.estimator.frames[i].observations.size(), expected[i].observations.size());
    for (size_t k = 0; k < expected[i].observations.size(); ++k) {
      EXPECT_EQ(setup.estimator.frames[i].observations[k].pixel, expected[i].observations[k].pixel);
    }
  }
}

TEST(ImageFeedTest, RefusesBadImagesWithTheReason) {
  Rigged setup;
  Session session(setup.config, setup.rig, setup.options, &setup.estimator);
  ImageFeed feed(setup.config.frontend, setup.rig, setup.options.lateness, &session);
  EXPECT_THAT(feed.AddImage(kStartNs, GreyImage{2, 2, {1, 2, 3, 4}}).message(), HasSubstr("found 2 x 2"));
  ASSERT_TRUE(feed.AddImage(kStartNs, ImageAt(setup.rig, 0)).ok());
  EXPECT_THAT(feed.AddImage(kStartNs, ImageAt(setup.rig, 0)).message(), HasSubstr("already"));
  ASSERT_TRUE(feed.AddImu(AtRest(kStartNs + kFrameNs)).ok());
  ASSERT_TRUE(feed.AddImu(AtRest(kStartNs + 4 * kFrameNs)).ok());
  EXPECT_THAT(feed.AddImage(kStartNs - 1, ImageAt(setup.rig, 0)).message(), HasSubstr("too late"));
}

}  // namespace
}  // namespace alidade
