#include <gtest/gtest.h>

#include "eval/run/turn_misfit.h"

namespace alidade {
namespace {

TEST(ClockVotes, OneFrameOfHighContrastDecides) {
  EXPECT_EQ(ClockVotes().Add(11, 0.9), ClockVerdict::kJumped);
  EXPECT_EQ(ClockVotes().Add(0.9, 11), ClockVerdict::kHolds);
}

TEST(ClockVotes, FramesOfLessContrastDecideWhenTheyAgree) {
  ClockVotes jumped;
  ClockVotes holds;
  for (int i = 1; i < ClockVotes::kFrames; ++i) {
    EXPECT_EQ(jumped.Add(4.2, 0.9), ClockVerdict::kOpen) << i;
    EXPECT_EQ(holds.Add(0.9, 4.2), ClockVerdict::kOpen) << i;
  }
  EXPECT_EQ(jumped.Add(4.2, 0.9), ClockVerdict::kJumped);
  EXPECT_EQ(holds.Add(0.9, 4.2), ClockVerdict::kHolds);
}

TEST(ClockVotes, AFrameThatLeansToNeitherOrTheOtherBeginsAgain) {
  for (const double as_is : {1.0, 0.2}) {
    ClockVotes votes;
    for (int i = 1; i < ClockVotes::kFrames; ++i) {
      EXPECT_EQ(votes.Add(4.2, 0.9), ClockVerdict::kOpen) << i;
    }
    EXPECT_EQ(votes.Add(as_is, 0.9), ClockVerdict::kOpen);
    for (int i = 1; i < ClockVotes::kFrames; ++i) {
      EXPECT_EQ(votes.Add(4.2, 0.9), ClockVerdict::kOpen) << i;
    }
    EXPECT_EQ(votes.Add(4.2, 0.9), ClockVerdict::kJumped);
  }
}

// Neither explanation fits: a wrong rotation of the camera, say.
TEST(ClockVotes, FramesThatNothingExplainsDecideNothing) {
  ClockVotes jumped;
  ClockVotes holds;
  for (int i = 0; i < 2 * ClockVotes::kFrames; ++i) {
    EXPECT_EQ(jumped.Add(40, 5), ClockVerdict::kOpen) << i;
    EXPECT_EQ(holds.Add(5, 40), ClockVerdict::kOpen) << i;
  }
}

}  // namespace
}  // namespace alidade
