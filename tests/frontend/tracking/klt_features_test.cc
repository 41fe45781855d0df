#include <gtest/gtest.h>

#include <map>

#include "frontend/tracking/klt_tracker.h"
#include "tests/frontend/tracking/synthetic_scene.h"
#include "tests/frontend/tracking/track_images.h"

// Which features a tracker holds: their places, numbers and count.

namespace alidade {
namespace {

using Eigen::Vector2d;
using test::kFrameNs;
using test::kHeightPx;
using test::kWidthPx;
using test::MustTrack;
using test::Render;
using test::TestRig;
using test::WithoutImu;

TEST(KltTrackerFeatures, SpreadsFeaturesOverTheGridAndKeepsThemApart) {
  const FrontendConfig config = WithoutImu();
  KltTracker tracker(config, TestRig());
  // Strong contrast in the left third only: the rest must get its share none the less.
  std::vector<unsigned char> image = Render(kWidthPx, kHeightPx, [](const Vector2d& u) { return u; });
  for (size_t i = 0; i < image.size(); ++i) {
    if (i % kWidthPx > kWidthPx / 3) {
      image[i] = static_cast<unsigned char>(100 + image[i] / 4);
    }
  }
  const TrackFrame frame = MustTrack(&tracker, 0, image);
  EXPECT_EQ(static_cast<int>(frame.observations.size()), config.max_features);
  std::map<int, int> cells;
  for (const TrackObservation& a : frame.observations) {
    const int column = static_cast<int>(a.pixel.x()) * config.grid_columns / kWidthPx;
    const int row = static_cast<int>(a.pixel.y()) * config.grid_rows / kHeightPx;
    ++cells[row * config.grid_columns + column];
    for (const TrackObservation& b : frame.observations) {
      // Sub-pixel refinement may bring two corners a little nearer than they were chosen.
      EXPECT_TRUE(a.track_id == b.track_id || (a.pixel - b.pixel).norm() > config.min_distance_px - 6);
    }
  }
  EXPECT_EQ(static_cast<int>(cells.size()), config.grid_columns * config.grid_rows);
  for (const auto& [cell, count] : cells) {
    EXPECT_LE(count, 6) << "cell " << cell;
  }
}

TEST(KltTrackerFeatures, IdsIncreaseAndNeverReturn) {
  KltTracker tracker(WithoutImu(), TestRig());
  const std::vector<unsigned char> wall = Render(kWidthPx, kHeightPx, [](const Vector2d& u) { return u; });
  const std::vector<unsigned char> black(wall.size(), 0);
  const TrackFrame first = MustTrack(&tracker, 0, wall);
  const TrackFrame dark = MustTrack(&tracker, kFrameNs, black);
  EXPECT_TRUE(dark.observations.empty());
  EXPECT_EQ(tracker.statistics().tracked, 0);
  EXPECT_EQ(tracker.statistics().lost, static_cast<int>(first.observations.size()));
  const TrackFrame again = MustTrack(&tracker, 2 * kFrameNs, wall);
  ASSERT_FALSE(again.observations.empty());
  EXPECT_GT(again.observations.front().track_id, first.observations.back().track_id);
  for (size_t i = 1; i < again.observations.size(); ++i) {
    EXPECT_LT(again.observations[i - 1].track_id, again.observations[i].track_id);
  }
}

TEST(KltTrackerFeatures, DropsTracksThatLeaveTheImageAndAccountsForEveryTrack) {
  KltTracker tracker(WithoutImu(), TestRig());
  size_t before = 0;
  int lost = 0;
  for (int k = 0; k < 6; ++k) {
    const TrackFrame frame =
        MustTrack(&tracker, k * kFrameNs, Render(kWidthPx, kHeightPx, [&](const Vector2d& u) -> Vector2d {
          return u + Vector2d(9.5 * k, 4.0 * k);
        }));
    const TrackerStatistics& statistics = tracker.statistics();
    EXPECT_EQ(
        static_cast<size_t>(statistics.tracked + statistics.lost + statistics.rejected + statistics.thinned),
        before);
    EXPECT_EQ(static_cast<size_t>(statistics.tracked + statistics.detected), frame.observations.size());
    lost += statistics.lost;
    const int margin_px = FrontendConfig().window_px / 2;
    for (const TrackObservation& observation : frame.observations) {
      EXPECT_TRUE(TestRig().camera.InImage(observation.pixel, margin_px)) << observation.pixel.transpose();
    }
    EXPECT_GT(frame.frontend_ms, 0);
    before = frame.observations.size();
  }
  EXPECT_GT(lost, 5);
}

}  // namespace
}  // namespace alidade
