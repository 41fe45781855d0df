#include "filter/imu_strain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "tests/support/cloned_window.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

class ImuStrainTest : public ::testing::TestWithParam<ErrorConvention> {
 protected:
  ImuStrainTest()
      : dataset_(test::SimulateOrDie(test::ClonedFlight(), 1)),
        initial_(test::DrawInitialState(dataset_, 1)) {}

  [[nodiscard]] FilterState Cloned(const Dataset& dataset, const NavEstimate& initial) const {
    return test::CloneEveryFrame(dataset, GetParam(), initial);
  }
  [[nodiscard]] FilterState Cloned() const { return Cloned(dataset_, initial_); }

  /// The correction that takes `from` to `to`, of the same clones.
  [[nodiscard]] VectorXd Between(const FilterState& from, const FilterState& to) const {
    VectorXd correction = VectorXd::Zero(from.covariance().dimension());
    for (size_t i = 0; i < from.clones().size(); ++i) {
      correction.segment<6>(from.CloneOffset(i)) =
          Local(GetParam(), from.clones()[i].T_WB, to.clones()[i].T_WB);
    }
    correction.segment<9>(from.CoreOffset()) = Local(GetParam(), from.nav(), to.nav());
    correction.segment<3>(from.CoreOffset() + 9) = to.bias().gyro - from.bias().gyro;
    correction.segment<3>(from.CoreOffset() + 12) = to.bias().accel - from.bias().accel;
    return correction;
  }

  /// Moves one clone.
  void Move(size_t clone, const Vector3d& shift, FilterState* state) const {
    const Pose& T_WB = state->clones()[clone].T_WB;
    VectorXd correction = VectorXd::Zero(state->covariance().dimension());
    correction.segment<6>(state->CloneOffset(clone)) =
        Local(GetParam(), T_WB, {T_WB.rotation, T_WB.translation + shift});
    state->Correct(correction);
  }

  /// Moves all clones at random by that deviation.
  void Shake(double deviation_m, std::uint64_t seed, FilterState* state) const {
    RandomStream random(seed, "strain");
    for (size_t i = 0; i < state->clones().size(); ++i) {
      Move(i, deviation_m * random.Normal3(), state);
    }
  }

  Dataset dataset_;
  NavEstimate initial_;
};

INSTANTIATE_TEST_SUITE_P(Conventions, ImuStrainTest, ::testing::ValuesIn(test::kAllConventions));

// GIVEN another state at the start WHEN the IMU carries it on THEN its clones are not strained.
TEST_P(ImuStrainTest, WhatTheImuExplainsIsNoStrain) {
  constexpr double kSize = 1e-5;
  FilterState state = Cloned();
  NavEstimate other = initial_;
  Vector9d error;
  error << 1, -2, 1, 3, 1, -2, 2, -1, 1;
  other.nav = Retract(ErrorConvention::kSo3xRn, other.nav, kSize * error);
  other.bias.gyro += kSize * Vector3d(1, 2, -1);
  other.bias.accel += kSize * Vector3d(-2, 1, 3);
  const VectorXd correction = Between(state, Cloned(dataset_, other));
  state.Correct(correction);
  for (size_t i = 1; i < state.clones().size(); ++i) {
    EXPECT_LT(state.strain().strain(i).norm(), 1e-3 * kSize) << i;
  }
}

TEST_P(ImuStrainTest, ACloneThatMovesStrainsItsNeighbours) {
  FilterState state = Cloned();
  const auto interval_s = [&](size_t i) {
    return SecondsBetween(state.clones()[i - 1].stamp_ns, state.clones()[i].stamp_ns);
  };
  const Vector3d shift(1e-3, -2e-3, 3e-3);
  Move(4, shift, &state);
  const Vector3d before = shift / interval_s(4);
  const Vector3d after = shift / interval_s(5);
  EXPECT_LT((state.strain().strain(3) - before).norm(), 1e-12);
  EXPECT_LT((state.strain().strain(4) + before + after).norm(), 1e-12);
  EXPECT_LT((state.strain().strain(5) - after).norm(), 1e-12);
  EXPECT_EQ(state.strain().strain(2).norm() + state.strain().strain(6).norm(), 0);
}

// GIVEN clones that leave, the second one between intervals of unequal length, THEN the others are strained
// as if they had never been there.
TEST_P(ImuStrainTest, ClonesThatLeaveTakeTheirStrainAlong) {
  FilterState all = Cloned();
  FilterState without = Cloned();
  without.RemoveClone(4);
  without.RemoveClone(4);
  Shake(1e-3, 3, &all);
  RandomStream random(3, "strain");
  for (size_t i = 0; i < all.clones().size(); ++i) {
    const Vector3d shift = 1e-3 * random.Normal3();
    if (i != 4 && i != 5) {
      Move(i < 4 ? i : i - 2, shift, &without);
    }
  }
  all.RemoveClone(4);
  all.RemoveClone(4);
  for (size_t i = 1; i < all.clones().size(); ++i) {
    EXPECT_LT((all.strain().strain(i) - without.strain().strain(i)).norm(), 1e-9) << i;
  }
  EXPECT_NEAR(all.strain().NormalizedSquare(), without.strain().NormalizedSquare(),
              1e-6 * without.strain().NormalizedSquare());
}

// GIVEN the noise of the IMU's sheet THEN the strain that it causes has a mean square of one.
TEST_P(ImuStrainTest, NoiseOfTheSheetHasTheStatedSize) {
  constexpr int kDraws = 100;
  const ImuNoise& noise = dataset_.rig.imu_noise;
  const double root_rate = std::sqrt(1 / SecondsBetween(dataset_.imu[0].stamp_ns, dataset_.imu[1].stamp_ns));
  const FilterState measured = Cloned();
  double sum = 0;
  int freedom = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    RandomStream random(static_cast<std::uint64_t>(draw) + 1, "strain");
    Dataset noisy = dataset_;
    for (ImuSample& sample : noisy.imu) {
      sample.gyro += root_rate * noise.gyro_noise_density_radps_sqrthz * random.Normal3();
      sample.accel += root_rate * noise.accel_noise_density_mps2_sqrthz * random.Normal3();
    }
    FilterState state = measured;
    state.Correct(Between(measured, Cloned(noisy, initial_)));
    sum += state.strain().NormalizedSquare();
    freedom = state.strain().Freedom();
  }
  EXPECT_EQ(freedom, 3 * (test::kClonedFrames - 2));
  // The mean of 2100 squares has a deviation of 0.03; neighbouring steps share a sample, which takes 5 %.
  EXPECT_NEAR(sum / (kDraws * freedom), 1, 0.12);
}

// GIVEN strain before and after the mark THEN the gradient is that of the quadratic form.
TEST_P(ImuStrainTest, TheGradientIsThatOfTheNormalizedSquare) {
  constexpr double kSize_m = 4e-6;
  FilterState before = Cloned();
  Shake(kSize_m, 5, &before);
  FilterState change = Cloned();
  Shake(kSize_m, 6, &change);
  FilterState after = before;
  after.strain().Mark();
  Shake(kSize_m, 6, &after);
  const double square = after.strain().NormalizedSquare();
  ASSERT_LT(square, after.strain().Freedom());
  const double expected =
      0.5 * (square - before.strain().NormalizedSquare() + change.strain().NormalizedSquare());
  EXPECT_NEAR(after.strain().ScaleGradient(), expected, 1e-9 * square);
  EXPECT_GT(std::abs(expected), 1e-3 * square);
}

TEST_P(ImuStrainTest, OfTheNewestIntervalOnlyWhatComesLastCounts) {
  FilterState state = Cloned();
  Shake(4e-6, 7, &state);
  state.strain().Mark();
  const size_t newest = state.clones().size() - 1;
  Move(newest, Vector3d(4e-6, 0, 0), &state);
  EXPECT_NE(state.strain().ScaleGradient(), 0);
  state.strain().MarkNewest();
  EXPECT_EQ(state.strain().ScaleGradient(), 0);
  Move(newest, Vector3d(0, 4e-6, 0), &state);
  EXPECT_NE(state.strain().ScaleGradient(), 0);
}

TEST_P(ImuStrainTest, StrainBeyondTheNoiseGivesNoGradient) {
  FilterState state = Cloned();
  state.strain().Mark();
  Shake(1e-2, 8, &state);
  EXPECT_GT(state.strain().NormalizedSquare(), state.strain().Freedom());
  EXPECT_EQ(state.strain().ScaleGradient(), 0);
}

// GIVEN a correction that takes a large strain away THEN there is no gradient either.
TEST_P(ImuStrainTest, StrainBeyondTheNoiseAtTheMarksGivesNoGradient) {
  FilterState state = Cloned();
  const Vector3d shift(1e-2, 0, 0);
  Move(4, shift, &state);
  state.strain().Mark();
  Move(4, -shift, &state);
  Shake(4e-6, 8, &state);
  EXPECT_LT(state.strain().NormalizedSquare(), state.strain().Freedom());
  EXPECT_EQ(state.strain().ScaleGradient(), 0);
}

TEST_P(ImuStrainTest, AWorldThatTurnsLeavesTheSquare) {
  FilterState state = Cloned();
  Shake(1e-5, 9, &state);
  const double square = state.strain().NormalizedSquare();
  state.strain().Turn(so3::Exp(Vector3d(0, 0, 1)));
  EXPECT_NEAR(state.strain().NormalizedSquare(), square, 1e-9 * square);
}

}  // namespace
}  // namespace alidade
