#include <gtest/gtest.h>

#include "filter/track_memory.h"
#include "tests/filter/track_memory_fixture.h"

namespace alidade {
namespace {

using test::CloneEveryFrame;
using test::Remembering;
using test::SeenFromClones;
constexpr int kFrames = test::kClonedFrames;

using TrackMemoryDriftTest = test::TrackMemoryFixture;
INSTANTIATE_TEST_SUITE_P(Conventions, TrackMemoryDriftTest, test::AllMemoryConventions(),
                         test::NameOfConvention);

// A hundred views of one standard deviation each: to either side in turn, then all to the same side.
TEST(InnovationDrift, InnovationsToOneSideAreADriftAndIndependentOnesAreNot) {
  constexpr double kLimit = 15.6;
  TrackMemory still;
  TrackMemory sliding;
  int caught_after = 0;
  for (int view = 1; view <= 100; ++view) {
    still.residual = Eigen::Vector2d(view % 2 == 0 ? 0.7 : -0.7, view % 3 == 0 ? 0.9 : -0.45);
    still.AddInnovation(2);
    EXPECT_FALSE(still.Drifts(kLimit)) << view;
    sliding.residual = Eigen::Vector2d(0.3, -0.1);
    sliding.AddInnovation(1);
    caught_after = caught_after == 0 && sliding.Drifts(kLimit) ? view : caught_after;
  }
  EXPECT_EQ(caught_after, 16);  // n^2 / n > 15.6
}

// Each view is well inside the gate of 9.2.
TEST_P(TrackMemoryDriftTest, GivenFurtherViewsThatAllMissToOneSideThenTheMemoryEnds) {
  const FilterState state = CloneEveryFrame(dataset_, GetParam());
  const auto remembers = [&](double gate_probability, double side) {
    VisionConfig vision = vision_;
    vision.gate_probability = gate_probability;
    Track track = SeenFromClones(state, PointBefore(state), 0, 5);
    FeatureUpdate update(Remembering(GetParam()), vision, kFrames + 1);
    update.Begin(state);
    EXPECT_EQ(update.AppendToRemember(state, track), TrackOutcome::kReady);
    update.Remember(state, 0, 1, 5, &track);
    for (size_t seen = 5; seen < kFrames && track.memory.active; ++seen) {
      track.views = SeenFromClones(state, PointBefore(state), seen, seen + 1).views;
      track.views.back().observation.z.x() += (seen % 2 == 0 ? side : 1) * 5.0 / 400;
      update.Begin(state);
      EXPECT_EQ(update.AppendRemembered(state, track), TrackOutcome::kReady);
      update.Remember(state, 0, 1, 8, &track);
    }
    return track.memory.active;
  };
  EXPECT_FALSE(remembers(0.99, 1));
  EXPECT_TRUE(remembers(0.99, -1));
  EXPECT_TRUE(remembers(1, 1));
}

}  // namespace
}  // namespace alidade
