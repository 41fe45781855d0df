#include "filter/scale_direction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/cloned_window.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

class ScaleDirectionTest : public test::ClonedWindow {
 protected:
  /// The error in which the cameras' distances from the oldest one are off by as much as they are.
  [[nodiscard]] VectorXd ErrorOfScale() const {
    constexpr double kStep = 1e-6;
    const Vector3d oldest = (state_.clones().front().T_WB * T_BC_).translation;
    return CorrectionTo([&](const Clone& clone) {
             return Moved(clone, kStep * ((clone.T_WB * T_BC_).translation - oldest));
           }) /
           kStep;
  }

  /// Over an error, the mean change of those distances in proportion to them.
  [[nodiscard]] VectorXd RowOfScale() const {
    constexpr double kStep = 1e-6;
    VectorXd row(state_.covariance().dimension());
    const auto along = [&](const FilterState& moved) {
      double sum = 0;
      double extent = 0;
      for (size_t i = 0; i < state_.clones().size(); ++i) {
        const Vector3d place = FromOldest(state_, i);
        sum += place.dot(FromOldest(moved, i));
        extent += place.squaredNorm();
      }
      return sum / extent;
    };
    for (Eigen::Index i = 0; i < row.size(); ++i) {
      FilterState more = state_;
      FilterState less = state_;
      more.Correct(kStep * VectorXd::Unit(row.size(), i));
      less.Correct(-kStep * VectorXd::Unit(row.size(), i));
      row[i] = (along(more) - along(less)) / (2 * kStep);
    }
    return row;
  }

  [[nodiscard]] static Vector3d FromOldest(const FilterState& state, size_t clone) {
    return state.clones()[clone].T_WC.translation - state.clones().front().T_WC.translation;
  }

  /// Moves every clone, as another velocity from the oldest one on would have.
  void ChangeShape(FilterState* state) const {
    const TimeNs start_ns = state->clones().front().stamp_ns;
    state->Correct(CorrectionTo(*state, [&](const Clone& clone) {
      return Moved(clone, SecondsBetween(start_ns, clone.stamp_ns) * change_mps_ + Vector3d(0.1, 0.2, -0.3));
    }));
  }

  [[nodiscard]] static Pose Moved(const Clone& clone, const Vector3d& shift) {
    return {clone.T_WB.rotation, clone.T_WB.translation + shift};
  }

  /// The clones' part of an error.
  [[nodiscard]] VectorXd OfClones(const VectorXd& error) const {
    return error.tail(error.size() - state_.CloneOffset(state_.clones().size() - 1));
  }

  Vector3d change_mps_{0.2, -0.1, 0.15};
};

INSTANTIATE_TEST_SUITE_P(Conventions, ScaleDirectionTest, ::testing::ValuesIn(test::kAllConventions));

// GIVEN corrections that change the window's shape THEN an error of scale before is one of scale after them,
// also where the tracks have determined the first clones alone.
TEST_P(ScaleDirectionTest, AnErrorOfScaleStaysOne) {
  for (const size_t determined : {state_.clones().size(), size_t{6}}) {
    ScaleDirection direction(state_.covariance().capacity());
    ASSERT_TRUE(direction.Take(state_, state_.clones()[determined - 1].serial));
    VectorXd errors = ErrorOfScale();
    for (int correction = 1; correction <= 2; ++correction) {
      ChangeShape(&state_);
      direction.Carry(&state_, errors);
      const VectorXd expected = ErrorOfScale();
      EXPECT_LT((OfClones(errors) - OfClones(expected)).norm(), 1e-5 * expected.norm()) << determined;
      const VectorXd core =
          ImuChartJacobian(GetParam(), state_.nav()) * errors.segment<15>(state_.CoreOffset());
      EXPECT_LT((core.segment<3>(6) - correction * change_mps_).norm(), 1e-5) << determined;
    }
  }
}

TEST_P(ScaleDirectionTest, TheCovarianceIsCarriedAsErrorsAre) {
  ScaleDirection direction(state_.covariance().capacity());
  ASSERT_TRUE(direction.Take(state_, state_.clones().back().serial));
  const Eigen::Index size = state_.covariance().dimension();
  Eigen::MatrixXd map(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    FilterState state = state_;
    ScaleDirection taken = direction;
    ChangeShape(&state);
    VectorXd error = VectorXd::Unit(size, i);
    taken.Carry(&state, error);
    map.col(i) = error;
  }
  const Eigen::MatrixXd expected = map * state_.covariance().Covariance() * map.transpose();
  ChangeShape(&state_);
  VectorXd none;
  direction.Carry(&state_, none);
  EXPECT_LT((state_.covariance().Covariance() - expected).norm(), 1e-9 * expected.norm());
  EXPECT_GT((map - Eigen::MatrixXd::Identity(size, size)).norm(), 0.1);
}

// GIVEN corrections that the covariance was carried over, twice WHEN that is taken back THEN the covariance
// is the one at Take.
TEST_P(ScaleDirectionTest, WhatWasCarriedIsTakenBack) {
  ScaleDirection direction(state_.covariance().capacity());
  ASSERT_TRUE(direction.Take(state_, state_.clones().back().serial));
  const Eigen::MatrixXd taken = state_.covariance().Covariance();
  VectorXd none;
  for (int carried = 0; carried < 2; ++carried) {
    ChangeShape(&state_);
    direction.Carry(&state_, none);
    change_mps_ = Vector3d(-0.1, 0.3, 0.1);
  }
  EXPECT_GT((state_.covariance().Covariance() - taken).norm(), 1e-3 * taken.norm());
  direction.TakeBack(&state_);
  EXPECT_LT((state_.covariance().Covariance() - taken).norm(), 1e-9 * taken.norm());
}

// GIVEN a gradient g along the direction THEN the correction is P l g / (1 + v |g|), v = l P l and l n = 1,
// with the l of the state where the direction was taken and the n of now: it never inverts the window.
TEST_P(ScaleDirectionTest, TheCorrectionForAGradientFollowsTheCovariance) {
  ScaleDirection direction(state_.covariance().capacity());
  ASSERT_TRUE(direction.Take(state_, state_.clones().back().serial));
  const VectorXd row = RowOfScale();
  VectorXd correction(row.size());
  for (int carried = 0; carried <= 1; ++carried) {
    const VectorXd l = row / row.dot(ErrorOfScale());
    const VectorXd covariance = state_.covariance().Covariance() * l;
    for (const double gradient : {0.7, -0.7, 1e6}) {
      direction.Descend(state_.covariance(), gradient, correction);
      const VectorXd expected = -gradient / (1 + l.dot(covariance) * std::abs(gradient)) * covariance;
      EXPECT_LT((correction - expected).norm(), 1e-5 * expected.norm()) << carried << " " << gradient;
      EXPECT_LE(std::abs(l.dot(correction)), 1 + 1e-5) << carried << " " << gradient;
    }
    ChangeShape(&state_);
    VectorXd none;
    direction.Carry(&state_, none);
  }
}

// GIVEN a step that may not be taken THEN the variance of the scale grows by a third of its square, also
// after the direction has been carried, and what is not correlated with the scale stays as it is.
TEST_P(ScaleDirectionTest, AStepThatIsNotTakenInflatesTheScale) {
  ScaleDirection direction(state_.covariance().capacity());
  ASSERT_TRUE(direction.Take(state_, state_.clones().back().serial));
  const VectorXd row = RowOfScale();
  for (int carried = 0; carried <= 1; ++carried) {
    const VectorXd l = row / row.dot(ErrorOfScale());
    for (const double gradient : {1e4, -30.0}) {
      const MatrixXd before = state_.covariance().Covariance();
      VectorXd step(row.size());
      direction.Descend(state_.covariance(), gradient, step);
      direction.Inflate(step, &state_);
      const double variance = l.dot(before * l);
      const double added = l.dot(step) * l.dot(step) / 3;
      const VectorXd along = before * l / variance;
      const MatrixXd after = state_.covariance().Covariance();
      EXPECT_GT(added, 0.01 * variance) << carried << " " << gradient;
      EXPECT_LT((after - before - added * along * along.transpose()).norm(), 1e-5 * (after - before).norm())
          << carried << " " << gradient;
    }
    ChangeShape(&state_);
    VectorXd none;
    direction.Carry(&state_, none);
  }
}

TEST_P(ScaleDirectionTest, AShapeThatNoTrackHasDeterminedIsNotCarried) {
  ScaleDirection direction(state_.covariance().capacity());
  EXPECT_FALSE(direction.Take(state_, state_.clones().front().serial));
  EXPECT_TRUE(direction.Take(state_, state_.clones()[1].serial));
}

}  // namespace
}  // namespace alidade
