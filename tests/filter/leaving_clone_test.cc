#include "filter/leaving_clone.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace alidade {
namespace {

/// A window of ten clones that is fed frame by frame; all tracks are seen in every frame.
class LeavingCloneTest : public ::testing::Test {
 protected:
  LeavingCloneTest() {
    filter_.window = 10;
    filter_.clone_policy = ClonePolicy::kSpread;
  }

  void Feed(int frames, bool shape_is_known = true) {
    for (int i = 0; i < frames; ++i) {
      ++serial_;
      Clone clone;
      clone.serial = serial_;
      clones_.push_back(clone);
      for (Track& track : tracks_) {
        track.last_serial = serial_;
        ++track.observations;
      }
      const int leaving = ChooseLeavingClone(filter_, clones_, tracks_, serial_, shape_is_known);
      EXPECT_EQ(leaving >= 0, clones_.size() == 11);
      EXPECT_LT(leaving, 10) << "the newest stays";
      if (leaving >= 0) {
        clones_.erase(clones_.begin() + leaving);
      }
    }
  }

  /// That are new from the next frame on.
  void AddTracks(size_t count) { tracks_.resize(tracks_.size() + count); }

  FilterConfig filter_;
  std::vector<Clone> clones_;
  std::vector<Track> tracks_;
  int serial_ = 0;
};

TEST_F(LeavingCloneTest, WhileAllTracksAreOldTheOldestStaysAndDistancesGrowWithAge) {
  AddTracks(20);
  Feed(60);
  EXPECT_EQ(clones_.front().serial, 1);
  EXPECT_EQ(clones_.back().serial, 60);
  EXPECT_GT(clones_[2].serial - clones_[1].serial, 2 * (clones_[9].serial - clones_[8].serial));
}

TEST_F(LeavingCloneTest, WhenMostTracksAreNewTheOldestLeaves) {
  AddTracks(20);
  Feed(30);
  tracks_.clear();
  AddTracks(20);
  Feed(10);
  EXPECT_GT(clones_.front().serial, 1);
}

// GIVEN clones at uneven distances THEN that one leaves whose neighbours are nearest to each other for its
// age.
TEST_F(LeavingCloneTest, TheOneBetweenNearNeighboursLeaves) {
  const auto leaving = [&](std::initializer_list<int> serials) {
    clones_.clear();
    for (const int serial : serials) {
      clones_.emplace_back().serial = serial;
    }
    Track old;
    old.last_serial = 100;
    old.observations = 100;
    return clones_[static_cast<size_t>(ChooseLeavingClone(filter_, clones_, {old}, 100, true))].serial;
  };
  EXPECT_EQ(leaving({1, 2, 30, 36, 42, 60, 70, 80, 90, 95, 100}), 36);
  EXPECT_EQ(leaving({1, 10, 22, 36, 42, 60, 70, 80, 97, 98, 100}), 10) << "3 apart, but young";
}

// GIVEN tracks that were all seen first by the second oldest clone THEN that is old enough for the oldest.
TEST_F(LeavingCloneTest, TracksAsOldAsTheSecondOldestKeepTheOldest) {
  Feed(1);
  AddTracks(20);
  Feed(10);
  EXPECT_EQ(clones_.front().serial, 1);
  clones_.clear();
  tracks_.clear();
  serial_ = 0;
  Feed(2);
  AddTracks(20);
  Feed(9);
  EXPECT_EQ(clones_.front().serial, 2);
}

// GIVEN a fifth of the tracks that are old THEN the oldest clone stays only while the window's shape is
// uncertain.
TEST_F(LeavingCloneTest, AnUncertainShapeKeepsALongerBaseline) {
  for (const bool shape_is_known : {true, false}) {
    clones_.clear();
    tracks_.clear();
    serial_ = 0;
    AddTracks(4);
    Feed(5, shape_is_known);
    AddTracks(16);
    Feed(15, shape_is_known);
    EXPECT_EQ(clones_.front().serial == 1, !shape_is_known);
  }
}

}  // namespace
}  // namespace alidade
