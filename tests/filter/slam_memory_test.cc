#include <gtest/gtest.h>

#include <tuple>

#include "tests/support/jacobian_checker.h"
#include "tests/support/landmark_flight.h"

// SLAM features of a filter that remembers tracks.

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::Flight;

class RememberedFeatureTest : public ::testing::TestWithParam<ErrorConvention> {};
INSTANTIATE_TEST_SUITE_P(Conventions, RememberedFeatureTest, ::testing::ValuesIn(test::kAllConventions),
                         [](const auto& test_case) { return std::string(ToString(test_case.param)); });

TEST_P(RememberedFeatureTest, APromotedMemoryLosesNothing) {
  FilterConfig filter = Flight::Filter();
  filter.error = GetParam();
  filter.track_memory = TrackMemoryPolicy::kCarry;
  filter.memory_depth_deviation = 0.5;
  FeatureUpdate update(filter, VisionConfig(), 12);
  SlamFeatures slam(filter, 12);
  Flight promoted(GetParam(), false);
  Flight joint(GetParam(), false);
  for (int i = 0; i < 9; ++i) {
    promoted.Frame();
    joint.Frame();
    Track& track = promoted.track_;
    if (i == 4) {
      update.Begin(promoted.state_);
      ASSERT_EQ(update.AppendToRemember(promoted.state_, track), TrackOutcome::kReady);
      update.Remember(promoted.state_, 0, 1, 0, &track);
      ASSERT_TRUE(track.memory.active);
      VectorXd correction(promoted.state_.covariance().dimension());
      SquareRootCovariance& covariance = promoted.state_.covariance();
      ASSERT_TRUE(covariance.Apply(update.Prepare(-1, &covariance), correction, nullptr));
    } else if (i == 5) {
      TrackStore store;
      store.tracks().push_back(track);
      slam.Promote(promoted.serial_, &store, &promoted.state_);
      track = store.tracks().front();
      EXPECT_TRUE(track.in_state);
      EXPECT_FALSE(track.memory.active);
      ASSERT_EQ(promoted.state_.landmarks().size(), 1u);
    }
    if (i >= 5) {
      promoted.ObserveLandmark(promoted.state_);
      promoted.Apply();
    }
  }
  promoted.state_.RemoveLandmark(0);
  joint.update_.Begin(joint.state_);
  ASSERT_EQ(joint.update_.Append(joint.state_, joint.track_), TrackOutcome::kReady);
  joint.Apply();
  const MatrixXd expected = joint.state_.covariance().Covariance();
  const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd difference = promoted.state_.covariance().Covariance() - expected;
  EXPECT_LT((scale.asDiagonal() * difference * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-8);
}

// GIVEN a track that five views made a memory of WHEN it becomes a landmark instead and sees on THEN nothing
// was lost: the state is that of one joint update of all views.
// A landmark stays linearised where it entered: with a velocity known to 0.3 m/s at 1.1 m/s, all depths are
// wrong together, however well the views agree.
TEST_P(RememberedFeatureTest, ARememberingFilterWaitsForAStateThatIsCertainEnough) {
  for (const auto& [memory, velocity_std, expected] :
       {std::tuple(TrackMemoryPolicy::kWindow, 0.01, TrackOutcome::kReady),
        std::tuple(TrackMemoryPolicy::kWindow, 0.3, TrackOutcome::kWaiting),
        std::tuple(TrackMemoryPolicy::kNone, 0.3, TrackOutcome::kReady)}) {
    FilterConfig filter = Flight::Filter();
    filter.error = GetParam();
    filter.track_memory = memory;
    filter.memory_depth_deviation = 0.2;
    filter.slam_max_depth_deviation = 0.2;
    FeatureUpdate update(filter, VisionConfig(), 12);
    SlamFeatures slam(filter, 12);
    Flight flight(GetParam(), false, velocity_std);
    for (int i = 0; i < 6; ++i) {
      flight.Frame();
    }
    update.Begin(flight.state_);
    slam.Begin();
    ASSERT_TRUE(slam.IsCandidate(flight.state_, flight.track_, flight.serial_));
    EXPECT_EQ(update.AppendLandmark(flight.state_, flight.track_, slam.TakeRows()), expected) << velocity_std;
    EXPECT_EQ(update.rows() > 0, expected == TrackOutcome::kReady);
  }
}

TEST_P(RememberedFeatureTest, ACarriedMemoryStaysOne) {
  SlamFeatures slam(Flight::Filter(), 12);
  Flight flight(GetParam(), false);
  flight.Frame();
  TrackStore store;
  store.tracks().push_back(flight.track_);
  store.tracks().front().observations = 100;
  TrackMemory& memory = store.tracks().front().memory;
  memory.active = true;
  memory.carried = true;
  slam.Promote(flight.serial_, &store, &flight.state_);
  EXPECT_TRUE(memory.active);
  EXPECT_FALSE(store.tracks().front().in_state);
  EXPECT_TRUE(flight.state_.landmarks().empty());
}

}  // namespace
}  // namespace alidade
