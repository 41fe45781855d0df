#include "eval/comparison/efficiency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "eval/report/efficiency_tables.h"

namespace alidade {
namespace {

using testing::HasSubstr;

CellResult MakeCell(const std::string& estimator, unsigned seed, double ori_deg, double pos_m) {
  CellResult cell;
  cell.estimator = estimator;
  cell.backend = estimator == "batch" ? "batch" : "filter";
  cell.smoothed = estimator == "batch";
  cell.sequence = "walk";
  cell.seed = seed;
  cell.status = "ok";
  cell.input_digest = "digest " + std::to_string(seed);
  cell.frames = 10;
  cell.rmse_ori_deg = ori_deg;
  cell.rmse_pos_m = pos_m;
  if (estimator == "batch") {
    cell.sigma_ori_deg = 0.5;
    cell.sigma_pos_m = 0.3;
    cell.filtering_sigma_ori_deg = 1;
    cell.filtering_sigma_pos_m = 0.6;
  }
  return cell;
}

// Two runs of each; root mean squares: filter 5/sqrt(2) deg, batch 1 deg.
Comparison MakeComparison() {
  Comparison comparison;
  comparison.cells = {MakeCell("fast", 1, 3, 0.9), MakeCell("fast", 2, 4, 0.9), MakeCell("batch", 1, 1, 0.3),
                      MakeCell("batch", 2, 1, 0.3)};
  return comparison;
}

TEST(Efficiency, IsTheBoundOverWhatWasAchieved) {
  const std::vector<Efficiency> entries = ComputeEfficiency(MakeComparison());
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].label, "fast");
  EXPECT_EQ(entries[0].pairs, 2);
  const double rmse = std::sqrt(12.5);
  EXPECT_NEAR(entries[0].rmse.ori, rmse, 1e-12);
  EXPECT_NEAR(entries[0].achieved.ori, 1 / rmse, 1e-12);
  EXPECT_NEAR(entries[0].achieved.pos, 1.0 / 3, 1e-12);
  EXPECT_NEAR(entries[0].smoothed.ori, 0.5 / rmse, 1e-12);
  EXPECT_NEAR(entries[0].smoothed.pos, 1.0 / 3, 1e-12);
  EXPECT_NEAR(entries[0].filtered.ori, 1 / rmse, 1e-12);
  EXPECT_NEAR(entries[0].filtered.pos, 2.0 / 3, 1e-12);
  EXPECT_EQ(entries[1].label, "batch");
  EXPECT_EQ(entries[1].achieved.pos, 1);
}

TEST(Efficiency, CountsOnlyRunsThatBothFinishedOnEqualInput) {
  Comparison comparison = MakeComparison();
  comparison.cells[1].status = "diverged";
  comparison.cells[1].rmse_ori_deg = 1e6;
  EXPECT_EQ(ComputeEfficiency(comparison)[0].pairs, 1);
  EXPECT_NEAR(ComputeEfficiency(comparison)[0].achieved.ori, 1.0 / 3, 1e-12);
  comparison.cells[2].input_digest = "other data";
  const Efficiency none = ComputeEfficiency(comparison)[0];
  EXPECT_EQ(none.pairs, 0);
  EXPECT_TRUE(std::isnan(none.achieved.ori));
}

TEST(Efficiency, NeedsABatch) {
  Comparison comparison = MakeComparison();
  comparison.cells.resize(2);
  EXPECT_TRUE(ComputeEfficiency(comparison).empty());
  EXPECT_TRUE(LayOutEfficiencyTables(comparison).empty());
}

TEST(Efficiency, TablesShowIt) {
  const std::vector<TextTable> tables = LayOutEfficiencyTables(MakeComparison());
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0].title, "Efficiency: walk");
  ASSERT_EQ(tables[0].rows.size(), 2u);
  EXPECT_EQ(tables[0].rows[0].cells.size(), tables[0].header.size());
  EXPECT_EQ(tables[0].rows[0].cells[3].text, "0.33");
  const std::string csv = EfficiencyCsv(ComputeEfficiency(MakeComparison()));
  EXPECT_THAT(csv, HasSubstr("estimator,sequence,pairs,rmse_ori_deg,"));
  EXPECT_THAT(csv, HasSubstr("\nbatch,walk,2,1,"));
}

// GIVEN the batch is better than everyone else, WHEN the best of a column is marked, THEN it is one of them.
TEST(Efficiency, TheBoundIsNoRival) {
  Comparison comparison = MakeComparison();
  comparison.cells.push_back(MakeCell("slow", 1, 5, 2));
  comparison.cells.push_back(MakeCell("slow", 2, 5, 2));
  const std::vector<Figure> figures = ListFigures(comparison);
  const size_t rmse = *FindFigure(figures, "rmse_pos_m");
  for (const AggregateRow& row : Aggregate(comparison, figures)) {
    EXPECT_EQ(row.best[rmse], row.label == "fast") << row.label;
  }
}

}  // namespace
}  // namespace alidade
