#include "eval/comparison/large_comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/numbers.h"
#include "eval/comparison/nees_over_time.h"

namespace alidade {
namespace {

/// A run of 600 rows whose NEES is `nees`.
CellResult RunOf(unsigned seed, double nees) {
  CellResult cell;
  cell.estimator = "a";
  cell.sequence = "s";
  cell.seed = seed;
  cell.status = "ok";
  for (int i = 0; i < 600; ++i) {
    cell.series.time_s.push_back(0.1 * i);
    cell.series.nees_pose.push_back(nees);
    cell.series.backend_ms.push_back(1);
  }
  cell.rpe = {{8, 3, 0.1, 0.2, {0.1, 0.1, 0.1}}};
  cell.sky.resize(1);
  return cell;
}

TEST(LargeComparison, AFewCellsStayWhole) {
  CellResult cell = RunOf(1, 6);
  const ShownCells shown(std::vector<size_t>(ShownCells::kMostShown, 0), 1);
  shown.Thin(0, &cell);
  EXPECT_TRUE(cell.shown);
  EXPECT_EQ(cell.series.time_s.size(), 600u);
  EXPECT_EQ(shown.note(), "");
}

// GIVEN more cells than are shown WHEN thinned THEN the first of each group have curves, failed ones their
// reason, and the mean NEES over time is that of all.
TEST(LargeComparison, ManyCellsKeepWhatTheMeansNeed) {
  std::vector<size_t> group;
  for (size_t i = 0; i < 2 * ShownCells::kMostShown; ++i) {
    group.push_back(i % 2);
  }
  const ShownCells shown(group, 2);
  Comparison comparison;
  for (const size_t index : {size_t{0}, group.size() - 1}) {
    comparison.cells.push_back(RunOf(static_cast<unsigned>(index), index == 0 ? 4 : 8));
    shown.Thin(index, &comparison.cells.back());
  }
  const CellResult &first = comparison.cells[0], &last = comparison.cells[1];
  EXPECT_TRUE(first.shown);
  EXPECT_FALSE(first.series.backend_ms.empty());
  EXPECT_LE(first.series.time_s.size(), 2 * ShownCells::kPoints + 20);
  EXPECT_FALSE(last.shown);
  EXPECT_EQ(last.series.time_s.size(), ShownCells::kPoints);
  EXPECT_TRUE(last.series.backend_ms.empty());
  EXPECT_TRUE(last.sky.empty());
  EXPECT_EQ(last.rpe[0].count, 3);
  EXPECT_TRUE(last.rpe[0].pos_errors_m.empty());
  const std::vector<NeesCurve> curves = AverageNees(comparison);
  ASSERT_EQ(curves.size(), 1u);
  EXPECT_THAT(curves[0].average.runs, testing::Each(2));
  EXPECT_THAT(curves[0].average.mean, testing::Each(6.0));
  EXPECT_THAT(shown.note(), testing::HasSubstr("of the first 2000 of 4000 runs"));

  CellResult failed = RunOf(1, kNan);
  failed.status = "failed";
  shown.Thin(group.size() - 1, &failed);
  EXPECT_TRUE(failed.shown);
}

}  // namespace
}  // namespace alidade
