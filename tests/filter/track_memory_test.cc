#include "filter/track_memory.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "tests/filter/track_memory_fixture.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

using test::CloneEveryFrame;
using test::Remembering;
using test::SeenFromClones;
constexpr int kFrames = test::kClonedFrames;

/// All error rows, in the state's order, of a memory's clone rows.
MatrixXd OverState(const FilterState& state, const Eigen::Ref<const MatrixXd>& over_slots) {
  MatrixXd rows = MatrixXd::Zero(over_slots.rows(), state.covariance().dimension());
  for (size_t i = 0; i < state.clones().size(); ++i) {
    rows.middleCols<6>(state.CloneOffset(i)) = over_slots.middleCols<6>(6 * state.clones()[i].slot);
  }
  return rows;
}

class TrackMemoryTest : public test::TrackMemoryFixture {
 protected:
  /// The memory after views [0, 5) of the track.
  TrackMemory Begin(const FilterState& state, const Vector3d& p_W) {
    Track track = SeenFromClones(state, p_W, 0, 5);
    FeatureUpdate update(Remembering(GetParam()), vision_, kFrames + 1);
    update.Begin(state);
    EXPECT_EQ(update.AppendToRemember(state, track), TrackOutcome::kReady);
    update.Remember(state, 0, 1, 0, &track);
    EXPECT_TRUE(track.memory.active);
    return track.memory;
  }
};
INSTANTIATE_TEST_SUITE_P(Conventions, TrackMemoryTest, test::AllMemoryConventions(), test::NameOfConvention);

TEST_P(TrackMemoryTest, GivenAWindowThatStaysThenSequentialUpdatesAreTheJointUpdate) {
  FilterState joint = CloneEveryFrame(dataset_, GetParam());
  FilterState sequential = joint;
  const Vector3d p_W = PointBefore(joint);
  VectorXd correction(joint.covariance().dimension());

  FilterConfig plain;
  plain.error = GetParam();
  FeatureUpdate all(plain, vision_, kFrames + 1);
  all.Begin(joint);
  ASSERT_EQ(all.Append(joint, SeenFromClones(joint, p_W, 0, kFrames)), TrackOutcome::kReady);
  ASSERT_TRUE(joint.covariance().Apply(all.Prepare(-1, &joint.covariance()), correction, nullptr));

  FeatureUpdate update(Remembering(GetParam()), vision_, kFrames + 1);
  Track track = SeenFromClones(sequential, p_W, 0, 5);
  for (size_t seen = 5; seen <= kFrames; ++seen) {
    update.Begin(sequential);
    ASSERT_EQ(track.memory.active ? update.AppendRemembered(sequential, track)
                                  : update.AppendToRemember(sequential, track),
              TrackOutcome::kReady);
    update.Remember(sequential, 0, 1, 0, &track);
    ASSERT_TRUE(
        sequential.covariance().Apply(update.Prepare(-1, &sequential.covariance()), correction, nullptr));
    EXPECT_LT(correction.norm(), 1e-9);
    if (seen < kFrames) {
      track.views = SeenFromClones(sequential, p_W, seen, seen + 1).views;
    }
  }
  const MatrixXd expected = joint.covariance().Covariance();
  const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd difference = sequential.covariance().Covariance() - expected;
  EXPECT_LT((scale.asDiagonal() * difference * scale.asDiagonal()).cwiseAbs().maxCoeff(), 1e-8);
}

// The baseline is as uncertain as the velocity is: rows linearised at it would bias the scale. Where the
// whole window stands does not matter.
TEST_P(TrackMemoryTest, GivenADepthThatOnlyTheStateLeavesOpenThenNoMemoryStarts) {
  const auto remembers = [&](TrackMemoryPolicy policy, double velocity_std, double position_std) {
    NavEstimate initial = test::DrawInitialState(dataset_, 1);
    initial.covariance.diagonal().segment<3>(3).setConstant(position_std * position_std);
    initial.covariance.diagonal().segment<3>(6).setConstant(velocity_std * velocity_std);
    const FilterState state = CloneEveryFrame(dataset_, GetParam(), initial);
    FilterConfig filter = Remembering(GetParam());
    filter.track_memory = policy;
    filter.memory_depth_deviation = 0.2;
    FeatureUpdate update(filter, vision_, kFrames + 1);
    Track track = SeenFromClones(state, PointBefore(state), 0, kFrames);
    update.Begin(state);
    EXPECT_EQ(update.AppendToRemember(state, track), TrackOutcome::kReady);
    update.Remember(state, 0, 1, 0, &track);
    return track.memory.active;
  };
  for (const TrackMemoryPolicy policy : {TrackMemoryPolicy::kWindow, TrackMemoryPolicy::kCarry}) {
    EXPECT_TRUE(remembers(policy, 0.01, 0.01));
    EXPECT_TRUE(remembers(policy, 0.01, 10));
    EXPECT_FALSE(remembers(policy, 1.0, 0.01));
  }
}

TEST_P(TrackMemoryTest, GivenACloneThatLeavesThenTheRowsAreTheMarginalOfItsConditional) {
  const FilterState state = CloneEveryFrame(dataset_, GetParam());
  const TrackMemory before = Begin(state, PointBefore(state));
  const TrackMemoryKeeper keeper(Remembering(GetParam()), kFrames + 1);
  CloneConditional conditional;
  ConditionClone(state, 0, 1, &conditional);
  ASSERT_EQ(conditional.neighbours, std::min<size_t>(CloneConditional::kMaxNeighbours, kFrames - 1));
  TrackMemory after = before;
  keeper.Carry(state, conditional, &after);

  // Unknowns (f, x_m, x_1, x_2 ...): the memory's rows, and x_m = G x_s + w.
  const auto width = static_cast<Index>(6 * conditional.neighbours);
  MatrixXd rows = MatrixXd::Zero(9, 9 + width);
  const Eigen::Matrix<double, 6, 6> whiten =
      conditional.covariance.llt().matrixL().solve(Matrix6d::Identity());
  const auto over_neighbours = [&](const TrackMemory& memory) {
    MatrixXd columns(3, width);
    for (size_t i = 0; i < conditional.neighbours; ++i) {
      columns.middleCols<6>(6 * static_cast<Index>(i)) =
          memory.clone_rows.middleCols<6>(6 * conditional.neighbour_slots[i]);
    }
    return columns;
  };
  const int leaving = 6 * conditional.leaving_slot;
  rows.topLeftCorner<3, 3>() = before.landmark_rows;
  rows.block<3, 6>(0, 3) = before.clone_rows.middleCols<6>(leaving);
  rows.topRightCorner(3, width) = over_neighbours(before);
  rows.block<6, 6>(3, 3) = whiten;
  rows.bottomRightCorner(6, width) = -whiten * conditional.gain.leftCols(width);
  MatrixXd ordered(9, 9 + width);
  ordered << rows.middleCols(3, 6), rows.leftCols(3), rows.rightCols(width);
  const MatrixXd information = ordered.transpose() * ordered;
  const Index kept = 3 + width;
  const MatrixXd expected =
      information.bottomRightCorner(kept, kept) -
      information.bottomLeftCorner(kept, 6) *
          information.topLeftCorner(6, 6).ldlt().solve(information.topRightCorner(6, kept));

  MatrixXd carried(3, kept);
  carried << after.landmark_rows, over_neighbours(after);
  if (GetParam() != ErrorConvention::kRightInvariant) {  // there the anchor may have moved
    const MatrixXd actual = carried.transpose() * carried;
    EXPECT_LT((actual - expected).norm(), 1e-6 * expected.norm());
  }
  EXPECT_TRUE(after.clone_rows.middleCols<6>(leaving).isZero(0));
  EXPECT_LT(after.landmark_rows.norm(), before.landmark_rows.norm()) << "something is lost";
  EXPECT_GT(after.landmark_rows.norm(), 0.5 * before.landmark_rows.norm()) << "but not much";
}

/// Rotation and translation of the whole world, in the right-invariant error: the same for every clone and
/// without the landmark's own position. Of the rotation, only yaw is unobservable; rows of views and memories
/// are blind to all of it.
MatrixXd WorldDirections(const FilterState& state) {
  MatrixXd directions = MatrixXd::Zero(state.covariance().dimension() + 3, 6);
  for (size_t i = 0; i < state.clones().size(); ++i) {
    directions.middleRows<6>(state.CloneOffset(i)).setIdentity();
  }
  directions.bottomRightCorner<3, 3>().setIdentity();
  return directions;
}

TEST(TrackMemoryTest, RightInvariantRowsHoldNoInformationOnTheFrameWhateverHappensToThem) {
  const Dataset dataset = test::SimulateOrDie(SimulatorConfig(), 1);
  FilterState state = CloneEveryFrame(dataset, ErrorConvention::kRightInvariant);
  const FilterConfig config = Remembering(ErrorConvention::kRightInvariant);
  const Vector3d p_W = state.clones().front().T_WC * Vector3d(0.5, -0.3, 4);
  Track track = SeenFromClones(state, p_W, 0, 5);
  FeatureUpdate update(config, VisionConfig{.max_relative_depth_deviation = 10}, kFrames + 1);
  TrackMemoryKeeper keeper(config, kFrames + 1);
  update.Begin(state);
  ASSERT_EQ(update.AppendToRemember(state, track), TrackOutcome::kReady);
  update.Remember(state, 0, 1, 0, &track);
  const auto expect_blind = [&](const char* when) {
    MatrixXd rows(3, state.covariance().dimension() + 3);
    rows << OverState(state, track.memory.clone_rows), track.memory.landmark_rows;
    EXPECT_LT((rows * WorldDirections(state)).norm(), 1e-8 * rows.norm()) << when;
  };
  expect_blind("at the start");
  RandomStream random(3, "correction");
  for (size_t seen = 5; seen < kFrames; ++seen) {
    VectorXd correction(state.covariance().dimension());
    for (Index i = 0; i < correction.size(); ++i) {
      correction[i] = 1e-3 * random.Normal();
    }
    keeper.Correct(state, correction, &track.memory);
    state.Correct(correction);
    expect_blind("after a correction");
    const NormalizedObservation view = SeenFromClones(state, p_W, seen, seen + 1).views.back().observation;
    TrackMemory extended;
    ASSERT_TRUE(keeper.Extend(state, track.memory, seen, view, 1, &extended));
    track.memory = extended;
    expect_blind("after a view");
    MatrixXd rows(2, state.covariance().dimension() + 3);
    rows << OverState(state, keeper.jacobian()), Eigen::Matrix<double, 2, 3>::Zero();
    EXPECT_LT((rows * WorldDirections(state)).norm(), 1e-8 * rows.norm());
  }
  while (state.clones().size() > 3) {
    CloneConditional conditional;
    ConditionClone(state, state.clones().size() / 2 - 1, 1, &conditional);
    keeper.Carry(state, conditional, &track.memory);
    state.RemoveClone(state.clones().size() / 2 - 1);
    expect_blind("after a clone left");
  }
}

TEST_P(TrackMemoryTest, GivenACorrectionThenTheLandmarkMovesWhereItsRowsPutIt) {
  FilterState state = CloneEveryFrame(dataset_, GetParam());
  TrackMemory memory = Begin(state, PointBefore(state));
  const TrackMemoryKeeper keeper(Remembering(GetParam()), kFrames + 1);
  // The world shifted as a whole: every clone by the same translation.
  VectorXd correction = VectorXd::Zero(state.covariance().dimension());
  const Vector3d shift(0.3, -0.2, 0.1);
  for (size_t i = 0; i < state.clones().size(); ++i) {
    const Pose& T_WB = state.clones()[i].T_WB;
    Pose moved = T_WB;
    moved.translation += shift;
    correction.segment<6>(state.CloneOffset(i)) = Local(GetParam(), T_WB, moved);
  }
  const Vector3d before = memory.p_W;
  keeper.Correct(state, correction, &memory);
  EXPECT_LT((memory.p_W - before - shift).norm(), 1e-8);
}

}  // namespace
}  // namespace alidade
