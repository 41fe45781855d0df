#include "eval/peers/peer_feed.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/dataset/dataset_writer.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// IMU samples at 10, 20, ... 60 ms and frames at the given times [ms].
PeerSequence MakeSequence(const std::vector<int>& frames_ms) {
  PeerSequence sequence;
  for (int i = 1; i <= 6; ++i) {
    sequence.dataset.imu.push_back(
        {i * TimeNs{10'000'000}, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()});
  }
  for (const int ms : frames_ms) {
    sequence.frames_ns.push_back(ms * TimeNs{1'000'000});
    sequence.dataset.frames.push_back({sequence.frames_ns.back(), {{7, Eigen::Vector2d(1, 2)}}});
  }
  return sequence;
}

/// "i20" an IMU sample at 20 ms, "f0" the first frame.
std::vector<std::string> Events(const PeerSequence& sequence, double offset_s) {
  std::vector<std::string> events;
  PeerSink sink;
  sink.imu = [&](const ImuSample& sample) {
    events.push_back("i" + std::to_string(sample.stamp_ns / 1'000'000));
  };
  sink.time_offset_s = [&] { return offset_s; };
  sink.frame = [&](size_t frame) {
    events.push_back("f" + std::to_string(frame));
    return Status::Ok();
  };
  EXPECT_TRUE(FeedPeer(sequence, sink).ok());
  return events;
}

TEST(FeedPeer, AFrameComesAfterTheFirstSampleThatIsLater) {
  EXPECT_THAT(Events(MakeSequence({25, 40}), 0),
              ElementsAre("i10", "i20", "i30", "f0", "i40", "i50", "f1", "i60"));
}

TEST(FeedPeer, FramesThatTheImuDoesNotCoverAreLeftOut) {
  EXPECT_THAT(Events(MakeSequence({5, 10, 55, 60, 70}), 0),
              ElementsAre("i10", "i20", "i30", "i40", "i50", "i60", "f2"));
}

TEST(FeedPeer, TheOffsetBringsFramesIntoImuTime) {
  EXPECT_THAT(Events(MakeSequence({5, 25}), 0.01),
              ElementsAre("i10", "i20", "f0", "i30", "i40", "f1", "i50", "i60"));
}

TEST(FeedPeer, AnEpochComesBeforeAFrameThatIsNotEarlier) {
  std::vector<std::string> events;
  PeerSink sink;
  sink.imu = [](const ImuSample&) {};
  sink.time_offset_s = [] { return 0.0; };
  sink.frame = [&](size_t frame) {
    events.push_back("f" + std::to_string(frame));
    return Status::Ok();
  };
  sink.epoch = [&](size_t epoch) { events.push_back("e" + std::to_string(epoch)); };
  constexpr TimeNs kMs = 1'000'000;
  // 5 and 10 are not covered by the IMU, nor is 60.
  ASSERT_TRUE(
      FeedPeer(MakeSequence({25, 40, 43}), sink, {5 * kMs, 10 * kMs, 25 * kMs, 42 * kMs, 55 * kMs, 60 * kMs})
          .ok());
  EXPECT_THAT(events, ElementsAre("e2", "f0", "f1", "e3", "f2", "e4"));
}

TEST(FeedPeer, AFaultEndsIt) {
  const PeerSequence sequence = MakeSequence({25, 40});
  int frames = 0;
  PeerSink sink{[](const ImuSample&) {}, [] { return 0.0; },
                [&](size_t) {
                  ++frames;
                  return Status::Input("torn");
                }};
  EXPECT_EQ(FeedPeer(sequence, sink).message(), "torn");
  EXPECT_EQ(frames, 1);
}

TEST(ReadPeerSequence, TakesTracksOrReportsWhatIsMissing) {
  const test::TemporaryFolder folder;
  Dataset dataset = MakeSequence({25, 40}).dataset;
  dataset.rig.camera =
      CameraModel::Create(DistortionModel::kNone, Eigen::Vector4d(400, 400, 320, 240), {}, 640, 480).value();
  ASSERT_TRUE(WriteDataset(dataset, folder.path()).ok());
  const Result<PeerSequence> read = ReadPeerSequence(folder.path(), "auto");
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_TRUE(read->from_tracks);
  EXPECT_THAT(read->frames_ns, ElementsAre(25'000'000, 40'000'000));
  EXPECT_THAT(ReadPeerSequence(folder.path(), "images").message(), HasSubstr("has no images"));
  EXPECT_EQ(ReadPeerSequence(folder.path(), "both").code(), StatusCode::kUsage);
  EXPECT_EQ(ReadPeerSequence(folder.File("none"), "auto").code(), StatusCode::kInput);
}

}  // namespace
}  // namespace alidade
