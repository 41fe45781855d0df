#include "eval/comparison/figure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "eval/comparison/aggregate.h"
#include "eval/comparison/paired.h"

namespace alidade {
namespace {

CellResult RunOf(const std::string& estimator, unsigned seed, const std::string& status,
                 std::optional<double> completion) {
  CellResult cell;
  cell.estimator = estimator;
  cell.sequence = "walk";
  cell.seed = seed;
  cell.status = status;
  cell.frames = 10;
  cell.ate_pos_m = 0.1 * seed;
  cell.completion = completion;
  return cell;
}

Statistic StatisticOf(const Comparison& comparison, const std::string& key, size_t row = 0) {
  const std::vector<Figure> figures = ListFigures(comparison);
  return Aggregate(comparison, figures).at(row).figures[*FindFigure(figures, key)];
}

std::vector<bool> BestOf(const Comparison& comparison, const std::string& key) {
  const std::vector<Figure> figures = ListFigures(comparison);
  std::vector<bool> best;
  for (const AggregateRow& row : Aggregate(comparison, figures)) {
    best.push_back(row.best[*FindFigure(figures, key)]);
  }
  return best;
}

TEST(Completion, GivenRunsThatWereLostThenItsMeanIsOverAllRuns) {
  Comparison comparison;
  comparison.cells = {RunOf("a", 1, "ok", 1), RunOf("a", 2, "diverged", 0.6),
                      RunOf("a", 3, "not_initialized", 0), RunOf("a", 4, "failed", std::nullopt)};
  const Statistic completion = StatisticOf(comparison, "completion");
  EXPECT_EQ(completion.count, 4) << "a run that failed before its first row counts as zero";
  EXPECT_DOUBLE_EQ(completion.mean, 0.4);
  EXPECT_EQ(StatisticOf(comparison, "ate_pos_m").count, 1);
}

TEST(Completion, GivenARunWithoutACameraThenItIsUnknown) {
  Comparison comparison;
  comparison.cells = {RunOf("a", 1, "ok", std::nullopt), RunOf("a", 2, "diverged", std::nullopt)};
  EXPECT_EQ(StatisticOf(comparison, "completion").count, 0);
}

TEST(Completion, GivenRunsThatWereLostThenTheMostCompleteIsBestAndPairsCountThem) {
  Comparison comparison;
  comparison.cells = {RunOf("a", 1, "ok", 0.7), RunOf("a", 2, "ok", 0.7), RunOf("b", 1, "ok", 1),
                      RunOf("b", 2, "diverged", 0.9)};
  EXPECT_EQ(BestOf(comparison, "completion"), std::vector<bool>({false, true}));
  const std::vector<Figure> figures = ListFigures(comparison);
  int pairs = 0;
  for (const PairedDifference& pair : ComparePairs(comparison, figures)) {
    if (figures[pair.figure].key == "completion") {
      pairs += pair.difference.count;
      EXPECT_DOUBLE_EQ(pair.difference.mean, -0.25);
    }
  }
  EXPECT_EQ(pairs, 2);
}

TEST(Completion, GivenNothingCompletedThenItIsFarFromIdealByAFiniteAmount) {
  Comparison comparison;
  const std::vector<Figure> figures = ListFigures(comparison);
  const Figure& completion = figures[*FindFigure(figures, "completion")];
  EXPECT_EQ(Badness(completion, 0), 1);
  EXPECT_EQ(Badness(completion, 1), 0);
}

TEST(RealtimeFactor, DependsOnTheLoadOfTheMachineAndIsNotPaired) {
  const std::vector<Figure> figures = ListFigures(Comparison());
  EXPECT_FALSE(IsPaired(figures[*FindFigure(figures, "realtime_factor")]));
  EXPECT_TRUE(IsPaired(figures[*FindFigure(figures, "completion")]));
}

TEST(Aggregate, GivenASmoothedEstimateThenItIsNeverBestAndNoLimitForTheOthers) {
  Comparison comparison;
  for (const unsigned seed : {1U, 2U}) {
    for (const char* name : {"causal", "worse", "smoothed"}) {
      CellResult cell = RunOf(name, seed, "ok", 1);
      cell.rmse_pos_m = name[0] == 'c' ? 0.2 : name[0] == 'w' ? 0.4 : 0.1;
      cell.smoothed = name[0] == 's';
      comparison.cells.push_back(cell);
    }
  }
  comparison.cells[0].status = comparison.cells[1].status = "diverged";  // the smoothed one alone lost none
  EXPECT_EQ(BestOf(comparison, "rmse_pos_m"), std::vector<bool>({true, false, false}));
  const std::vector<AggregateRow> rows = Aggregate(comparison, ListFigures(comparison));
  EXPECT_TRUE(rows[2].smoothed);
  EXPECT_FALSE(rows[0].smoothed);
  EXPECT_DOUBLE_EQ(rows[1].rmse_pos_to_best, 2);
  EXPECT_DOUBLE_EQ(rows[2].rmse_pos_to_best, 0.5);
  EXPECT_EQ(comparison.SmoothedEstimators(), std::vector<std::string>({"smoothed"}));
}

}  // namespace
}  // namespace alidade
