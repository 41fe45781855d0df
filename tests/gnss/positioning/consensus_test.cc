#include "gnss/positioning/consensus.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"

namespace alidade {
namespace {

/// `outliers` of `count` measurements of three unknowns and a bias of group 1 are late by 50 and more; the
/// rest has unit noise about `truth`.
struct Problem {
  Problem(int count, int outliers, std::uint64_t seed) {
    RandomStream random(seed, "consensus");
    rows.jacobian.setZero(count, 4);
    rows.residual.resize(count);
    rows.measurements = count;
    for (int i = 0; i < count; ++i) {
      group.push_back(i % 3 == 0 ? 1 : 0);
      rows.jacobian.row(i) << 2 * random.Normal(), 2 * random.Normal(), 1, group.back();
      rows.residual[i] = random.Normal() - rows.jacobian.row(i).dot(truth);
      rows.residual[i] += i < outliers ? random.Uniform(50, 200) : 0;
    }
  }

  Eigen::Vector4d truth{3, -4, 100, 25};
  WhitenedRows rows;
  std::vector<int> group;
};

TEST(ConsensusTest, UpToTwoFifthsOfLateMeasurementsHaveNoEffect) {
  for (const int outliers : {8, 10}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Problem problem(25, outliers, seed);
      const std::optional<Consensus> consensus = SeekConsensus(problem.rows, problem.group);
      ASSERT_TRUE(consensus.has_value());
      EXPECT_LT((consensus->step - problem.truth).norm(), 3) << seed;
      EXPECT_LT(consensus->spread, 2) << seed;
      for (Eigen::Index i = 0; i < 25; ++i) {
        EXPECT_EQ(consensus->Agrees(i), i >= outliers) << seed << ", measurement " << i;
        EXPECT_EQ(std::abs(consensus->residual[i]) > 20, i < outliers) << seed << ", measurement " << i;
      }
    }
  }
}

TEST(ConsensusTest, EqualInputGivesEqualBits) {
  const Problem problem(24, 8, 7);
  const std::optional<Consensus> first = SeekConsensus(problem.rows, problem.group);
  const std::optional<Consensus> second = SeekConsensus(problem.rows, problem.group);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->step, second->step);
}

TEST(ConsensusTest, FewMeasurementsAgreeByChance) {
  EXPECT_FALSE(SeekConsensus(Problem(9, 0, 1).rows, Problem(9, 0, 1).group).has_value());
  EXPECT_TRUE(SeekConsensus(Problem(10, 0, 1).rows, Problem(10, 0, 1).group).has_value());
}

TEST(ConsensusTest, RowsOfAPriorTakeNoPart) {
  Problem problem(24, 8, 3);
  const Eigen::VectorXd alone = SeekConsensus(problem.rows, problem.group)->step;
  problem.rows.jacobian.conservativeResize(25, 4);
  problem.rows.jacobian.row(24) << 0, 0, 0, 1e6;
  problem.rows.residual.conservativeResize(25);
  problem.rows.residual[24] = 1e9;
  EXPECT_EQ(SeekConsensus(problem.rows, problem.group)->step, alone);
}

}  // namespace
}  // namespace alidade
