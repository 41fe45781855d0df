#include "eval/dataset/dataset_tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/files/input_file.h"
#include "tests/support/good_sequence.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr char kWithRatio[] = "#timestamp [ns],track_id,u [px],v [px],noise_ratio\n";

/// The frames of tracks.csv, which are written as they were read.
std::vector<TrackFrame> RoundTrip(const std::string& text) {
  const test::TemporaryFolder folder;
  const Result<std::vector<TrackFrame>> frames = ReadTracks(folder.Write("tracks.csv", text));
  EXPECT_TRUE(frames.ok()) << frames.message();
  const std::string again = folder.File("again.csv");
  EXPECT_TRUE(frames.ok() && WriteTracks(*frames, again).ok());
  EXPECT_EQ(ReadWholeFile(again).value(), text);
  return frames.ok() ? *frames : std::vector<TrackFrame>(2);
}

TEST(DatasetTracks, HoldANoiseRatioWhereAnyObservationHasOne) {
  const std::vector<TrackFrame> frames =
      RoundTrip(std::string(kWithRatio) + "1000,1,10,20,1\n1000,2,30,40,0.25\n2000,1,11,21,3\n");
  ASSERT_EQ(frames[0].observations.size(), 2U);
  EXPECT_EQ(frames[0].observations[1].noise_ratio, 0.25);
  EXPECT_EQ(frames[1].observations[0].noise_ratio, 3);
}

TEST(DatasetTracks, HaveNoColumnWhereAllRatiosAreOne) {
  const std::vector<TrackFrame> frames =
      RoundTrip(std::string(test::kTracksHeader) + "1000,1,10,20\n2000,1,11,21\n");
  ASSERT_EQ(frames[0].observations.size(), 1U);
  EXPECT_EQ(frames[0].observations[0].noise_ratio, 1);
}

TEST(DatasetTracks, RefuseARatioThatIsNone) {
  const test::TemporaryFolder folder;
  for (const std::string ratio : {"0", "-1", "1e-4", "2000", "x"}) {
    const std::string path =
        folder.Write("tracks.csv", std::string(kWithRatio) + "1000,1,10,20," + ratio + "\n");
    const std::string message = ReadTracks(path).message();
    EXPECT_THAT(message, HasSubstr("tracks.csv:2: column 5 (noise_ratio): found '" + ratio + "'"));
  }
  const std::string torn = folder.Write("tracks.csv", std::string(kWithRatio) + "1000,1,10,20\n");
  EXPECT_THAT(ReadTracks(torn).message(), HasSubstr("tracks.csv:2"));
  const std::string other =
      folder.Write("tracks.csv", "#timestamp [ns],track_id,u [px],v [px],quality\n1000,1,1,1,1\n");
  EXPECT_THAT(ReadTracks(other).message(), HasSubstr("'noise_ratio'"));
}

}  // namespace
}  // namespace alidade
