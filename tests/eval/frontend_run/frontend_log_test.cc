#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "eval/frontend_run/frontend_summary.h"
#include "eval/frontend_run/log_cache.h"
#include "eval/frontend_run/track_overlay.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

/// Three images: tracks 1 and 2, then 1 alone, then none.
FrontendRun SomeRun() {
  FrontendRun run;
  run.frames.push_back({100, {{1, {10.1, 20.2}}, {2, {30.25, 1.0 / 3}}}, 4.0});
  run.frames.push_back({200, {{1, {11, 21}}}, 2.0});
  run.frames.push_back({300, {}, 3.0});
  run.statistics.push_back({.detected = 2, .mean_track_length = 1});
  run.statistics.push_back({.tracked = 1, .rejected = 1, .mean_track_length = 2});
  run.statistics.push_back({.lost = 1});
  return run;
}

TEST(FrontendLog, IsReadBackToTheLastBit) {
  const test::TemporaryFolder folder;
  const FrontendRun run = SomeRun();
  ASSERT_TRUE(WriteFrontendRun(run, "some source", folder.path()).ok());
  const std::optional<FrontendRun> kept = ReadFrontendRun("some source", folder.path());
  ASSERT_TRUE(kept.has_value());
  ASSERT_EQ(kept->frames.size(), 3U) << "a frame without tracks is a frame";
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    EXPECT_EQ(kept->frames[i].stamp_ns, run.frames[i].stamp_ns);
    EXPECT_EQ(kept->frames[i].frontend_ms, run.frames[i].frontend_ms);
    ASSERT_EQ(kept->frames[i].observations.size(), run.frames[i].observations.size());
    for (std::size_t k = 0; k < run.frames[i].observations.size(); ++k) {
      EXPECT_EQ(kept->frames[i].observations[k].track_id, run.frames[i].observations[k].track_id);
      EXPECT_EQ(kept->frames[i].observations[k].pixel, run.frames[i].observations[k].pixel);
    }
  }
  EXPECT_EQ(kept->statistics[1].rejected, 1);
  EXPECT_EQ(kept->statistics[1].mean_track_length, 2);
}

TEST(FrontendLog, OfAnotherSourceOrChangedIsNotUsed) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(ReadFrontendRun("some source", folder.path()).has_value()) << "there is none";
  ASSERT_TRUE(WriteFrontendRun(SomeRun(), "some source", folder.path()).ok());
  EXPECT_FALSE(ReadFrontendRun("another source", folder.path()).has_value());
  std::ofstream(folder.File("tracks.csv"), std::ios::app) << "300,7,1,1\n";
  EXPECT_FALSE(ReadFrontendRun("some source", folder.path()).has_value());
}

TEST(FrontendSummary, CountsLivesAndShares) {
  const FrontendRun run = SomeRun();
  const FrontendSummary summary = SummarizeFrontend(run.frames, run.statistics);
  EXPECT_EQ(summary.images, 3);
  EXPECT_EQ(summary.tracks, 2);
  EXPECT_DOUBLE_EQ(summary.features_per_frame, 1);
  EXPECT_DOUBLE_EQ(summary.mean_length, 1.5) << "one lived two frames, one a single frame";
  EXPECT_DOUBLE_EQ(summary.mean_ms, 3);
  // The first image follows no track and has no share: (1 of 2, 0 of 1) rejected, (0 of 2, 1 of 1) lost.
  EXPECT_DOUBLE_EQ(summary.rejected_share, 0.25);
  EXPECT_DOUBLE_EQ(summary.lost_share, 0.5);
  EXPECT_TRUE(std::isnan(SummarizeFrontend(run.frames, {}).lost_share));
}

TEST(TrackOverlay, DrawsTracksUponTheImage) {
  const test::TemporaryFolder folder;
  FrontendRun run = SomeRun();
  run.frames[1].observations = {{1, {60, 21}}};
  GreyImage image{.width_px = 80, .height_px = 40, .pixels = std::vector<unsigned char>(80 * 40, 200)};
  ASSERT_TRUE(WriteTrackOverlay(image, run.frames, 1, folder.File("a.png")).ok());
  const GreyImage drawn = ReadGreyImage(folder.File("a.png")).value();
  ASSERT_EQ(drawn.pixels.size(), image.pixels.size());
  EXPECT_NE(drawn.pixels[21 * 80 + 60], 200) << "the track";
  EXPECT_NE(drawn.pixels[21 * 80 + 40], 200) << "its way there from (10, 20)";
  EXPECT_EQ(drawn.pixels[5 * 80 + 5], 200) << "nothing";
}

}  // namespace
}  // namespace alidade
