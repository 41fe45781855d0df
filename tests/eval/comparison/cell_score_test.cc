#include "eval/comparison/cell_score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "eval/comparison/series_rows.h"
#include "tests/eval/report/synthetic_comparison.h"

namespace alidade {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(SeriesRows, GivenASpikeBetweenTheRegularRowsThenItIsKeptAndMarked) {
  CellSeries series = test::SyntheticSeries(2000, 0.1, 1, 2, 5);
  series.backend_ms[1003] = 250;
  series.error[777](4) = -30;
  series.nis_ratio[1501] = kNan;
  const SeriesRows rows = PickRows(series, 100);
  EXPECT_LE(rows.kept.size(), 220U);
  EXPECT_TRUE(std::is_sorted(rows.kept.begin(), rows.kept.end()));
  EXPECT_THAT(rows.kept, ::testing::IsSupersetOf({0, 777, 1003, 1999}));
  for (size_t k = 0; k < rows.kept.size(); ++k) {
    EXPECT_EQ(rows.regular[k], rows.kept[k] % 20 == 0) << rows.kept[k];
  }
  const CellSeries taken = TakeRows(series, rows);
  ASSERT_EQ(taken.time_s.size(), rows.kept.size());
  EXPECT_EQ(*std::max_element(taken.backend_ms.begin(), taken.backend_ms.end()), 250);
  EXPECT_TRUE(taken.rank.empty());
  // What is thinned again keeps it, and never makes a regular row of it.
  const SeriesRows again = PickRows(taken, 50);
  for (size_t k = 0; k < again.kept.size(); ++k) {
    EXPECT_EQ(again.regular[k], rows.kept[again.kept[k]] % 40 == 0);
  }
  EXPECT_THAT(TakeRows(taken, again).backend_ms, ::testing::Contains(250));
}

TEST(SeriesRows, GivenFewerRowsThanAllowedThenAllAreRegular) {
  const SeriesRows rows = PickRows(test::SyntheticSeries(50, 0.1, 1, 2, 5), 100);
  EXPECT_EQ(rows.kept.size(), 50U);
  EXPECT_THAT(rows.regular, ::testing::Each(true));
  EXPECT_TRUE(PickRows(CellSeries(), 100).kept.empty());
}

TEST(CellScore, GivenInnovationsThenTheirMeanAndShareInsideAreThoseOfAHandCalculation) {
  RunResult run;
  run.records.resize(5);
  const std::vector<std::pair<double, int>> frames = {{10, 10}, {21, 10}, {6, 4}, {0.4, 4}, {0, 0}};
  for (size_t i = 0; i < frames.size(); ++i) {
    run.records[i].statistics.nis = frames[i].first;
    run.records[i].statistics.nis_dof = frames[i].second;
    run.records[i].statistics.propagate_ms = static_cast<double>(i);
    run.records[i].statistics.gnss_nis = 2 * frames[i].first;
    run.records[i].statistics.gnss_nis_dof = i == 2 ? 0 : frames[i].second;
  }
  CellResult cell;
  ScoreRun(nullptr, run, EvaluationOptions(), &cell);
  EXPECT_DOUBLE_EQ(*cell.innovations.ratio, 37.4 / 28);
  // 95 % of chi-square: 3.2470 to 20.4832 with 10 degrees of freedom, 0.4844 to 11.1433 with 4.
  EXPECT_DOUBLE_EQ(*cell.innovations.inside, 0.5);
  EXPECT_NEAR(cell.innovations.band->first, 0.4844 / 4, 1e-4);
  EXPECT_NEAR(cell.innovations.band->second, 11.1433 / 4, 1e-4);
  EXPECT_DOUBLE_EQ(*cell.sensor_innovations.at("gnss").ratio, 2 * 31.4 / 24);
  EXPECT_DOUBLE_EQ(*cell.sensor_innovations.at("gnss").inside, 2.0 / 3) << "20, 42 and 0.8 of 10, 10 and 4";
  EXPECT_DOUBLE_EQ(*cell.propagate_ms, 2);
  EXPECT_FALSE(cell.frontend_ms) << "the tracks were read from a file";
  EXPECT_FALSE(cell.gated_share) << "no track met the gate";
  EXPECT_FALSE(cell.ate_pos_m) << "there is no truth";
  EXPECT_EQ(cell.features_per_frame, 0.0) << "zero is a value";
  EXPECT_FALSE(CellResult().innovations.ratio);
}

// GIVEN GNSS at half the camera's rate and an outage THEN every frame has the newest epoch's, but in the
// outage.
TEST(CellScore, GivenGnssSlowerThanTheCameraThenItsInnovationsAreHeldButNotThroughAnOutage) {
  const auto score = [](bool with_gnss) {
    RunResult run;
    Trajectory truth;
    for (int i = 0; i < 100; ++i) {
      RunRecord& record = run.records.emplace_back();
      record.estimate.stamp_ns = i * kSecondNs / 10;
      record.estimate.covariance.setIdentity();
      record.statistics.gnss_nis = i;
      record.statistics.gnss_nis_dof = with_gnss && i % 2 == 0 && (i < 20 || i >= 60) ? 2 : 0;
      TrajectoryPoint& point = truth.points.emplace_back();
      point.stamp_ns = record.estimate.stamp_ns;
    }
    CellResult cell;
    ScoreRun(&truth, run, EvaluationOptions(), &cell);
    const auto found = cell.series.sensor_nis_ratio.find("gnss");
    return found == cell.series.sensor_nis_ratio.end() ? std::vector<double>() : found->second;
  };
  EXPECT_TRUE(score(false).empty());
  const std::vector<double> ratio = score(true);
  ASSERT_EQ(ratio.size(), 100U);
  EXPECT_EQ(ratio[0], 0);
  EXPECT_EQ(ratio[7], 3);
  EXPECT_EQ(ratio[38], 9) << "two seconds after the last epoch";
  EXPECT_TRUE(std::isnan(ratio[39]));
  EXPECT_TRUE(std::isnan(ratio[59]));
  EXPECT_EQ(ratio[60], 30);
}

}  // namespace
}  // namespace alidade
