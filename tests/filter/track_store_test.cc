#include "filter/track_store.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alidade {
namespace {

std::vector<TrackObservation> Seen(std::initializer_list<std::int64_t> ids) {
  std::vector<TrackObservation> observations;
  for (const std::int64_t id : ids) {
    observations.push_back({id, Eigen::Vector2d(0.01 * static_cast<double>(id), 0)});
  }
  return observations;
}

class TrackStoreTest : public ::testing::Test {
 protected:
  CameraModel camera_;
  PixelNoise noise_{{.noise_ratios = true}};
  TrackStore store_;
};

TEST_F(TrackStoreTest, MergesById) {
  EXPECT_EQ(store_.AddFrame(camera_, noise_, 0, Seen({3, 7})), 0);
  EXPECT_EQ(store_.AddFrame(camera_, noise_, 1, Seen({1, 3, 9})), 0);
  ASSERT_EQ(store_.tracks().size(), 4u);
  EXPECT_EQ(store_.tracks()[0].id, 1);
  EXPECT_EQ(store_.tracks()[1].id, 3);
  EXPECT_EQ(store_.tracks()[1].views.size(), 2u);
  EXPECT_EQ(store_.tracks()[2].last_serial, 0);
}

TEST_F(TrackStoreTest, EndedTracksLeave) {
  store_.AddFrame(camera_, noise_, 0, Seen({3, 7}));
  store_.AddFrame(camera_, noise_, 1, Seen({7}));
  store_.RemoveEnded(1);
  ASSERT_EQ(store_.tracks().size(), 1u);
  EXPECT_EQ(store_.tracks()[0].id, 7);
  store_.AddFrame(camera_, noise_, 2, Seen({8}));
  EXPECT_EQ(store_.tracks().back().views.size(), 1u) << "re-used storage starts empty";
}

TEST_F(TrackStoreTest, ARemovedBaseTakesItsRoundsAlong) {
  store_.AddFrame(camera_, noise_, 0, Seen({3}));
  store_.AddFrame(camera_, noise_, 1, Seen({3}));
  store_.tracks()[0].base_rounds = 2;
  store_.RemoveClone(1);
  EXPECT_EQ(store_.tracks()[0].base_rounds, 2);
  store_.RemoveClone(0);
  EXPECT_EQ(store_.tracks()[0].base_rounds, 0);
  EXPECT_TRUE(store_.tracks()[0].views.empty());
}

TEST_F(TrackStoreTest, CountsWhatTheLensCannotSee) {
  const std::vector<TrackObservation> far = {{1, Eigen::Vector2d(1e6, 0)}, {2, Eigen::Vector2d(0, 0)}};
  EXPECT_EQ(store_.AddFrame(camera_, noise_, 0, far), 1);
  ASSERT_EQ(store_.tracks().size(), 1u);
}

TEST_F(TrackStoreTest, ANoiseRatioDividesTheWeights) {
  const std::vector<TrackObservation> seen = {{1, Eigen::Vector2d(3, 4), 1}, {2, Eigen::Vector2d(3, 4), 2.5}};
  store_.AddFrame(camera_, noise_, 0, seen);
  ASSERT_EQ(store_.tracks().size(), 2u);
  const Eigen::Matrix2d plain = store_.tracks()[0].views[0].observation.sqrt_information;
  EXPECT_EQ(2.5 * store_.tracks()[1].views[0].observation.sqrt_information, plain);
  store_.Clear();
  store_.AddFrame(camera_, PixelNoise(VisionConfig()), 1, seen);
  EXPECT_EQ(store_.tracks()[1].views[0].observation.sqrt_information, plain);
}

TEST_F(TrackStoreTest, ANoiseRatioThatIsNoneCountsAsInvalid) {
  const Eigen::Vector2d pixel(3, 4);
  EXPECT_EQ(
      store_.AddFrame(camera_, noise_, 0, {{1, pixel, 0}, {2, pixel, -1}, {3, pixel, NAN}, {4, pixel, 1}}),
      3);
}

}  // namespace
}  // namespace alidade
