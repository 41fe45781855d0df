#include "eval/comparison/nees_over_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/eval/report/synthetic_comparison.h"

namespace alidade {
namespace {

// GIVEN runs of a consistent filter WHEN averaged THEN the average is in its band 95 % of the time, and one
// of a filter whose errors are 1.5 times what it claims hardly ever is.
TEST(NeesOverTime, SeparatesAConsistentFilterFromAnOverconfidentOne) {
  std::vector<CellResult> honest, bold;
  std::vector<const CellResult*> honest_cells, bold_cells;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    honest.push_back(test::SyntheticCell("honest", "walk", seed, 0.1, 1.0, 1, 600));
    bold.push_back(test::SyntheticCell("bold", "walk", seed, 0.1, 1.5, 1, 600));
  }
  for (size_t i = 0; i < honest.size(); ++i) {
    honest_cells.push_back(&honest[i]);
    bold_cells.push_back(&bold[i]);
  }
  bold[0].status = "diverged";
  const NeesOverTime fair = AverageNees(honest_cells);
  ASSERT_EQ(fair.mean.size(), 600U);
  EXPECT_EQ(fair.runs[10], 30);
  // Chi-square of 180 degrees of freedom over 30: R, qchisq(c(.025, .975), 180) / 30.
  EXPECT_NEAR(fair.band[10].first, 4.8247, 1e-4);
  EXPECT_NEAR(fair.band[10].second, 7.3015, 1e-4);
  EXPECT_GT(fair.share_inside, 0.85);
  const NeesOverTime wrong = AverageNees(bold_cells);
  EXPECT_EQ(wrong.runs[10], 29) << "a lost run is not averaged";
  EXPECT_LT(wrong.share_inside, 0.05);
}

TEST(NeesOverTime, GivenRunsOfUnequalLengthThenTheBandFollowsTheirNumber) {
  CellResult brief = test::SyntheticCell("a", "walk", 1, 0.1, 1, 1, 100);
  CellResult whole = test::SyntheticCell("a", "walk", 2, 0.1, 1, 1, 200);
  const NeesOverTime average = AverageNees({&brief, &whole});
  ASSERT_EQ(average.mean.size(), 200U);
  EXPECT_EQ(average.runs[99], 2);
  EXPECT_EQ(average.runs[100], 1);
  EXPECT_GT(average.band[100].second, average.band[99].second);
  EXPECT_NEAR(average.mean[50], (brief.series.nees_pose[50] + whole.series.nees_pose[50]) / 2, 1e-12);
  EXPECT_DOUBLE_EQ(average.mean[150], whole.series.nees_pose[150]);
}

TEST(NeesOverTime, GivenAMeanThenItsVerdictFollowsTheBand) {
  EXPECT_EQ(NeesVerdict(6, {4.8, 7.3}), "consistent");
  EXPECT_EQ(NeesVerdict(8, {4.8, 7.3}), "overconfident");
  EXPECT_EQ(NeesVerdict(3, {4.8, 7.3}), "cautious");
  EXPECT_EQ(NeesVerdict(std::nan(""), {4.8, 7.3}), "");
}

}  // namespace
}  // namespace alidade
