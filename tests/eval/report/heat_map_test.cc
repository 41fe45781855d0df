#include "eval/report/heat_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/eval/report/synthetic_comparison.h"

namespace alidade {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CellResult MapCell(const std::string& estimator, const std::string& sequence, unsigned seed, double nees,
                   double rmse_m) {
  CellResult cell;
  cell.estimator = estimator;
  cell.backend = estimator == "batch" ? "batch" : "filter";
  cell.smoothed = estimator == "batch";
  cell.sequence = sequence;
  cell.seed = seed;
  cell.status = "ok";
  cell.frames = 10;
  cell.nees_pose = nees;
  cell.rmse_pos_m = rmse_m;
  return cell;
}

Comparison TwoRegimes() {
  Comparison comparison;
  comparison.cells = {MapCell("a", "slow", 1, 3, 0.1),      MapCell("a", "slow", 2, 9, 0.3),
                      MapCell("b", "slow", 1, 60, 0.4),     MapCell("b", "slow", 2, 36, 0.6),
                      MapCell("batch", "slow", 1, 6, 0.05), MapCell("batch", "slow", 2, 6, 0.05),
                      MapCell("a", "fast", 1, 1.5, 0.2),    MapCell("a", "fast", 2, 1.5, 0.2),
                      MapCell("b", "fast", 1, 6, 0.1),      MapCell("b", "fast", 2, 6, 0.1)};
  comparison.cells[9].status = "diverged";
  comparison.groups = {{"fast", "reporting"}};
  return comparison;
}

std::vector<HeatMap> MapsOf(const Comparison& comparison) {
  const std::vector<Figure> figures = ListFigures(comparison);
  return MakeHeatMaps(Aggregate(comparison, figures), figures);
}

TEST(HeatMaps, GivenRunsThenTheNumbersAreThoseOfAHandCalculation) {
  const std::vector<HeatMap> maps = MapsOf(TwoRegimes());
  ASSERT_EQ(maps.size(), 2U) << "there is no orientation";
  const HeatMap& nees = maps[0];
  EXPECT_EQ(nees.key, "nees_map");
  EXPECT_THAT(nees.labels, ElementsAre("a", "b", "batch"));
  ASSERT_EQ(nees.rows.size(), 2U);
  EXPECT_EQ(nees.rows[0].sequence, "slow");
  EXPECT_EQ(nees.rows[0].group, "");
  EXPECT_EQ(nees.rows[1].group, "reporting");
  EXPECT_EQ(nees.rows[0].cells[0].number, "1.00");
  EXPECT_EQ(nees.rows[0].cells[0].detail, "worst 1.50");
  EXPECT_TRUE(nees.rows[0].cells[0].strong);
  EXPECT_EQ(nees.rows[0].cells[1].number, "8.00");
  EXPECT_EQ(nees.rows[0].cells[1].detail, "worst 10.0");
  EXPECT_FALSE(nees.rows[0].cells[1].strong);
  EXPECT_EQ(nees.rows[1].cells[0].number, "0.25");
  EXPECT_EQ(nees.rows[1].cells[1].detail, "1/2 ok");
  EXPECT_FALSE(nees.rows[1].cells[1].strong) << "a run was lost";
  EXPECT_EQ(nees.rows[1].cells[2].number, kDash);
  const HeatMap& rmse = maps[1];
  EXPECT_EQ(rmse.rows[0].cells[0].number, "1.00");
  EXPECT_EQ(rmse.rows[0].cells[0].detail, "0.200 m");
  EXPECT_TRUE(rmse.rows[0].cells[0].strong);
  EXPECT_EQ(rmse.rows[0].cells[1].number, "2.50");
  EXPECT_EQ(rmse.rows[0].cells[2].number, "0.25") << "the bound is not a rival";
  EXPECT_EQ(rmse.rows[1].cells[0].number, "1.00") << "an estimator that lost a run is not the lowest";
  EXPECT_EQ(rmse.rows[1].cells[1].number, "0.50");
}

TEST(HeatMaps, GivenOneSequenceThenThereIsNoMap) {
  Comparison comparison = TwoRegimes();
  comparison.cells.resize(6);
  EXPECT_TRUE(MapsOf(comparison).empty());
}

TEST(HeatMaps, GivenAnEstimatorThatLostEveryRunThenTheCellShowsHow) {
  Comparison comparison = TwoRegimes();
  comparison.cells[8].status = comparison.cells[9].status = "not_initialized";
  EXPECT_EQ(MapsOf(comparison)[0].rows[1].cells[1].number, "no start");
}

double Luminance(const std::string& colour) {
  double sum = 0;
  for (const size_t at : {1U, 3U, 5U}) {
    sum += std::stoi(colour.substr(at, 2), nullptr, 16) / 3.0;
  }
  return sum;
}

TEST(HeatColours, GivenALogarithmicScaleThenDistanceFromOneDarkensEvenlyAndTheTextStaysReadable) {
  const std::vector<HeatMap> maps = MapsOf(TwoRegimes());
  const HeatMap& nees = maps[0];
  EXPECT_EQ(HeatColour(nees, 1), "#ffffff");
  EXPECT_EQ(HeatColour(nees, 100), HeatColour(nees, 4)) << "cut at the darkest";
  EXPECT_NE(HeatColour(nees, 0.5), HeatColour(nees, 2));
  double last = 256;
  for (int k = 0; k < 8; ++k) {
    const double value = std::pow(1.2, k);
    const double here = Luminance(HeatColour(nees, value));
    EXPECT_LT(here, last);
    last = here;
    EXPECT_NEAR(Luminance(HeatColour(nees, 1 / value)), here, 30) << "as dark on both sides";
    EXPECT_GT(std::abs(here - Luminance(HeatInk(nees, value))), 75) << value;
    EXPECT_GT(std::abs(Luminance(HeatColour(nees, 1 / value)) - Luminance(HeatInk(nees, 1 / value))), 75);
  }
  EXPECT_EQ(HeatColour(maps[1], 0.25), "#ffffff") << "one side";
  EXPECT_EQ(HeatColour(nees, std::nan("")), "#f0f2f4");
}

TEST(HeatColours, GivenALegendThenItRunsFromOneEndToTheOther) {
  const std::vector<HeatMap> maps = MapsOf(TwoRegimes());
  std::vector<std::string> texts;
  for (const auto& [value, text] : HeatLegend(maps[0])) {
    texts.push_back(text);
  }
  EXPECT_THAT(texts, ElementsAre("\u2264 0.25", "0.4", "0.63", "1", "1.6", "2.5", "\u2265 4"));
  EXPECT_EQ(HeatLegend(maps[1]).size(), 4U);
}

TEST(HeatTable, GivenGroupsThenTheyHaveAColumn) {
  const std::vector<HeatMap> maps = MapsOf(TwoRegimes());
  const TextTable table = HeatTable(maps[0]);
  EXPECT_THAT(table.title, ::testing::StartsWith("Map: Pose NEES / 6 ("));
  EXPECT_THAT(table.header, ElementsAre("sequence", "group", "a", "b", "batch"));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].cells[1].text, kDash);
  EXPECT_EQ(table.rows[0].cells[2].text, "1.00 (worst 1.50)");
  EXPECT_TRUE(table.rows[0].cells[2].best);
  EXPECT_EQ(table.rows[1].cells[1].text, "reporting");
  Comparison ungrouped = TwoRegimes();
  ungrouped.groups.clear();
  EXPECT_THAT(HeatTable(MapsOf(ungrouped)[0]).header, ElementsAre("sequence", "a", "b", "batch"));
}

TEST(HeatFigure, GivenAMapThenEveryNumberIsPrintedOnItsColour) {
  const std::vector<HeatMap> maps = MapsOf(TwoRegimes());
  const std::string svg = HeatFigure(maps[0]);
  EXPECT_THAT(svg, HasSubstr("width=\"252pt\""));
  for (const char* text : {">8.00<", ">worst 10.0<", ">1/2 ok<", ">reporting<", ">slow<", ">batch<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_THAT(svg, HasSubstr("fill=\"" + HeatColour(maps[0], 0.25) + "\""));
  EXPECT_EQ(svg, HeatFigure(maps[0]));
}

}  // namespace
}  // namespace alidade
