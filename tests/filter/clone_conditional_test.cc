#include "filter/clone_conditional.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/cloned_window.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using test::CloneEveryFrame;

class CloneConditionalTest : public ::testing::TestWithParam<ErrorConvention> {};

INSTANTIATE_TEST_SUITE_P(Conventions, CloneConditionalTest, ::testing::ValuesIn(test::kAllConventions));

TEST_P(CloneConditionalTest, GivenARemovedCloneThenItIsPredictedByItsNeighbours) {
  constexpr int kFrames = 20;  // more than are asked for a prediction
  const Dataset dataset = test::SimulateOrDie(SimulatorConfig(), 1);
  const FilterState state = CloneEveryFrame(dataset, GetParam(), test::DrawInitialState(dataset, 1), kFrames);
  const MatrixXd p = state.covariance().Covariance();
  for (const size_t leaving : {size_t{0}, size_t{3}, size_t{kFrames - 2}}) {
    CloneConditional conditional;
    ConditionClone(state, leaving, 1, &conditional);
    // The deviation of x_m - G x_s in the filter's own covariance.
    MatrixXd map = MatrixXd::Zero(6, p.rows());
    map.middleCols<6>(state.CloneOffset(leaving)).setIdentity();
    Matrix6d sum = Matrix6d::Zero();
    for (size_t i = 0; i < conditional.neighbours; ++i) {
      const auto gain = conditional.gain.middleCols<6>(6 * static_cast<Index>(i));
      sum += gain;
      for (size_t k = 0; k < state.clones().size(); ++k) {
        if (state.clones()[k].slot == conditional.neighbour_slots[i]) {
          map.middleCols<6>(state.CloneOffset(k)) = -gain;
        }
      }
    }
    const MatrixXd residual = map * p * map.transpose();
    EXPECT_LT((residual - conditional.covariance).norm(), 1e-6 * residual.norm() + 1e-14) << leaving;
    // Where all of them are is no concern of it, and no further one makes its noise larger.
    EXPECT_LT((sum - Matrix6d::Identity()).norm(), 1e-9);
    // Rows of past updates couple clones that are far apart: w must not depend on the one at the window's
    // end.
    const size_t farthest = leaving < kFrames / 2 ? kFrames - 1 : 0;
    MatrixXd end = MatrixXd::Zero(6, p.rows());
    end.middleCols<6>(state.CloneOffset(farthest)).setIdentity();
    end.middleCols<6>(state.CloneOffset(leaving == 0 ? 1 : leaving - 1)) = -Matrix6d::Identity();
    const MatrixXd shared = map * p * end.transpose();
    EXPECT_LT(shared.norm(), 1e-6 * std::sqrt(residual.norm() * (end * p * end.transpose()).norm()));
    const Index next = state.CloneOffset(leaving == 0 ? 1 : leaving - 1);
    MatrixXd alone = MatrixXd::Zero(6, p.rows());
    alone.middleCols<6>(state.CloneOffset(leaving)).setIdentity();
    alone.middleCols<6>(next) = -Matrix6d::Identity();
    EXPECT_LT(residual.trace(), (alone * p * alone.transpose()).trace());
  }
}

TEST_P(CloneConditionalTest, GivenManyMemoriesThenTheNoiseTheyShareCountsAsOftenAsTheyShareADirectionOfIt) {
  const FilterState state = CloneEveryFrame(test::SimulateOrDie(SimulatorConfig(), 1), GetParam());
  CloneConditional alone;
  ConditionClone(state, 0, 1, &alone);
  for (const auto& [memories, factor] : {std::pair(5, 1.0), std::pair(12, 2.0), std::pair(120, 20.0)}) {
    CloneConditional shared;
    ConditionClone(state, 0, static_cast<size_t>(memories), &shared);
    EXPECT_LT((shared.covariance - factor * alone.covariance).norm(), 1e-9 * shared.covariance.norm());
  }
}

}  // namespace
}  // namespace alidade
