#include "eval/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "eval/comparison/aggregate.h"
#include "eval/comparison/nees_over_time.h"
#include "eval/report/report_data.h"
#include "eval/report/report_series.h"
#include "eval/report/tables.h"
#include "eval/report/tables_terminal.h"
#include "eval/report/text_table.h"
#include "tests/eval/report/synthetic_comparison.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::ReadFile;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

CellResult Cell(const std::string& estimator, unsigned seed, double ate_pos_m, double nees_pose) {
  CellResult cell;
  cell.estimator = estimator;
  cell.backend = "filter";
  cell.sequence = "walk";
  cell.seed = seed;
  cell.status = "ok";
  cell.frames = 10;
  cell.ate_pos_m = ate_pos_m;
  cell.nees_pose = nees_pose;
  return cell;
}

size_t Index(const std::vector<Figure>& figures, const std::string& key) {
  for (size_t i = 0; i < figures.size(); ++i) {
    if (figures[i].key == key) {
      return i;
    }
  }
  ADD_FAILURE() << "no figure " << key;
  return 0;
}

std::vector<bool> BestOf(const Comparison& comparison, const std::string& key) {
  const std::vector<Figure> figures = ListFigures(comparison);
  std::vector<bool> best;
  for (const AggregateRow& row : Aggregate(comparison, figures)) {
    best.push_back(row.best[Index(figures, key)]);
  }
  return best;
}

TEST(Aggregate, GivenSeedsThenMeanAndStandardErrorAreThoseOfAHandCalculation) {
  const Statistic statistic = ComputeStatistic({1, kNan, 2, 6});
  EXPECT_EQ(statistic.count, 3);
  EXPECT_DOUBLE_EQ(statistic.mean, 3);
  EXPECT_DOUBLE_EQ(statistic.standard_error, std::sqrt(7.0 / 3));  // deviation sqrt(14 / 2), over sqrt(3)
  EXPECT_TRUE(std::isnan(ComputeStatistic({5}).standard_error));
  EXPECT_TRUE(std::isnan(ComputeStatistic({}).mean));
}

TEST(Aggregate, GivenARunThatWasLostThenItIsCountedAndKeptOutOfTheMeans) {
  Comparison comparison;
  comparison.cells = {Cell("a", 1, 1, 6), Cell("a", 2, 100, 900), Cell("a", 3, 3, 6), Cell("a", 4, 0, 0)};
  comparison.cells[1].status = "diverged";
  comparison.cells[3].status = "not_initialized";
  const std::vector<Figure> figures = ListFigures(comparison);
  const AggregateRow row = Aggregate(comparison, figures).at(0);
  EXPECT_EQ(row.cells, 4);
  EXPECT_EQ(row.ok, 2);
  EXPECT_EQ(row.diverged, 1);
  EXPECT_EQ(row.not_initialized, 1);
  EXPECT_DOUBLE_EQ(row.figures[Index(figures, "ate_pos_m")].mean, 2);
  // chi-square with 12 degrees of freedom: 4.4038 and 23.3367 at 2.5 % and 97.5 %, over two runs.
  EXPECT_NEAR(row.nees_pose_band.first, 2.2019, 1e-4);
  EXPECT_NEAR(row.nees_pose_band.second, 11.6683, 1e-4);
}

TEST(Aggregate, GivenRivalsThenTheLowestErrorAndTheNeesNearestToItsFreedomAreBest) {
  Comparison comparison;
  comparison.cells = {Cell("a", 1, 0.3, 2.5), Cell("b", 1, 0.2, 12.5), Cell("c", 1, 0.2, 11.5)};
  EXPECT_EQ(BestOf(comparison, "ate_pos_m"), std::vector<bool>({false, true, true}))
      << "equal values share it";
  EXPECT_EQ(BestOf(comparison, "nees_pose"), std::vector<bool>({false, false, true}))
      << "by ratio, not distance";
  EXPECT_EQ(BestOf(comparison, "features_per_frame"), std::vector<bool>({false, false, false}));
}

TEST(Aggregate, GivenEstimatorsThatLostARunThenTheyCannotBeBest) {
  Comparison comparison;
  comparison.cells = {Cell("a", 1, 0.3, 6), Cell("a", 2, 0.3, 6), Cell("b", 1, 0.4, 6), Cell("b", 2, 0.4, 6),
                      Cell("c", 1, 0.1, 6), Cell("c", 2, 0.1, 6), Cell("d", 1, 0.3, 6), Cell("d", 2, 0.3, 6)};
  comparison.cells[5].status = "diverged";  // would be the lowest
  comparison.cells[7].status = "diverged";  // would share it
  EXPECT_EQ(BestOf(comparison, "ate_pos_m"), std::vector<bool>({true, false, false, false}));
}

TEST(Aggregate, GivenOneEstimatorWithTwoBackEndsThenTheRowsAreApart) {
  Comparison comparison;
  comparison.cells = {Cell("a", 1, 0.3, 6), Cell("a", 1, 0.2, 6)};
  comparison.cells[1].backend = "smoother";
  EXPECT_THAT(ListLabels(Aggregate(comparison, ListFigures(comparison))),
              ::testing::ElementsAre("a (filter)", "a (smoother)"));
}

TEST(TableLayout, GivenValuesThenTheyAreRoundedAsAPersonReads) {
  EXPECT_EQ(FormatValue(0.12345, 3), "0.123");
  EXPECT_EQ(FormatValue(0, 3), "0.000");
  EXPECT_EQ(FormatValue(0.0012345, 3), "0.0012");
  EXPECT_EQ(FormatValue(12345678, 3), "1.2e+07");
  EXPECT_EQ(FormatValue(kNan, 3), "\u2013");
  EXPECT_EQ(FormatStatistic({2, 0.5, 0.0004}, 3, "+-"), "0.500+-0.000");
  EXPECT_EQ(FormatStatistic({1, 0.5, kNan}, 3, "+-"), "0.500");
}

TEST(Tables, GivenAComparisonThenSummaryHasARowACellWithTheColumnsOthersRelyOn) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteTables(test::SyntheticComparison(50), folder.path()).ok());
  const std::vector<std::string> lines = Lines(ReadFile(folder.File("summary.csv")));
  ASSERT_EQ(lines.size(), 13U);
  EXPECT_EQ(
      lines[0],
      "estimator,backend,sequence,seed,status,input_digest,frames,duration_s,path_m,rmse_pos_m,rmse_ori_deg,"
      "ate_pos_m,ate_ori_deg,align,rpe_5m_pos_m,rpe_5m_ori_deg,rpe_10m_pos_m,rpe_10m_ori_deg,rpe_25m_pos_m,"
      "rpe_25m_ori_deg,nees_pose,nees_ori,nees_pos,coverage_3sigma,frontend_ms,backend_ms,backend_ms_p95,"
      "features_per_frame,gated_share,silent_s,alarm_inside_share,completion,realtime_factor,mode,message");
  EXPECT_THAT(lines[1], ::testing::StartsWith("po_invio_multi,filter,figure8,1,ok,5f1c1"));
  EXPECT_THAT(lines[12], ::testing::StartsWith("vins_mono_class,smoother,V1_01_easy,2,failed,"));
  EXPECT_THAT(lines[12],
              ::testing::EndsWith(
                  ",0,,,,,,,,,,,,,,,,,,,,,,,,,0,,causal,\"cam0/tracks.csv:12: </script><b>\"\"torn\"\" row, "
                  "expected 4 columns\""));
}

TEST(Tables, GivenAComparisonThenAggregateHasARowAnEstimatorAndSequence) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteTables(test::SyntheticComparison(50), folder.path()).ok());
  const std::vector<std::string> lines = Lines(ReadFile(folder.File("aggregate.csv")));
  ASSERT_EQ(lines.size(), 7U);
  EXPECT_THAT(lines[0],
              ::testing::StartsWith("estimator,backend,sequence,runs,ok,diverged,not_initialized,failed,"
                                    "rmse_pos_m_mean,rmse_pos_m_se,"));
  EXPECT_THAT(lines[0], ::testing::EndsWith(
                            "nees_pos_band_low,nees_pos_band_high,nees_verdict,nees_inside_share,"
                            "rmse_pos_ratio,rmse_ori_ratio,rmse_pos_to_best,rmse_ori_to_best,group,mode"));
  EXPECT_THAT(lines[6], ::testing::StartsWith("vins_mono_class,smoother,V1_01_easy,2,1,0,0,1,"));
}

TEST(Tables, GivenNamesWithSpecialCharactersThenMarkdownAndLatexEscapeThem) {
  const test::TemporaryFolder folder;
  Comparison comparison;
  comparison.title = "A & B";
  comparison.cells = {Cell("a_b|c", 1, 0.1, 6), Cell("d", 1, 0.2, 6)};
  comparison.references = {{"the paper", "d", "walk", {{"ate_pos_m", 0.15}}}};
  ASSERT_TRUE(WriteTables(comparison, folder.path()).ok());
  const std::string markdown = ReadFile(folder.File("tables.md"));
  EXPECT_THAT(markdown, HasSubstr("| a\\_b\\|c | 1/1 |"));
  EXPECT_THAT(markdown, HasSubstr("**0.100**"));
  EXPECT_THAT(markdown, Not(HasSubstr("**0.200**")));
  EXPECT_THAT(markdown, HasSubstr("| *d, the paper* |"));
  EXPECT_THAT(markdown, HasSubstr("*0.150*"));
  const std::string latex = ReadFile(folder.File("tables.tex"));
  EXPECT_THAT(latex, HasSubstr("{a\\_b|c} & {1/1}"));
  EXPECT_THAT(latex, HasSubstr("\\textbf{0.100}"));
  EXPECT_THAT(latex, HasSubstr("\\textit{d, the paper}"));
  EXPECT_THAT(latex, HasSubstr("A \\& B"));
}

TEST(Tables, GivenADifferenceToTheBestThatIsNotSignificantThenItIsMarked) {
  Comparison comparison;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const double drawn = 0.01 * seed;
    comparison.cells.push_back(Cell("best", seed, 0.10 + drawn, 6));
    comparison.cells.push_back(Cell("near", seed, 0.115 + (seed == 2 ? -drawn : drawn), 6));
    comparison.cells.push_back(Cell("far", seed, 0.50 + drawn, 6));
  }
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteTables(comparison, folder.path()).ok());
  const std::string latex = ReadFile(folder.File("tables.tex"));
  EXPECT_THAT(latex, HasSubstr("\\textbf{0.120 $\\pm$ 0.006}"));
  EXPECT_THAT(latex, HasSubstr("{0.122 $\\pm$ 0.015 $\\approx$}"));
  EXPECT_THAT(latex, HasSubstr("{0.520 $\\pm$ 0.006}"));
  EXPECT_THAT(ReadFile(folder.File("tables.md")), HasSubstr("0.122 \u00b1 0.015 \u2248 |"));
}

TEST(Tables, GivenAFolderThatCannotBeThenTheErrorNamesIt) {
  const test::TemporaryFolder folder;
  const std::string file = folder.Write("taken", "");
  const Status status = WriteTables(test::SyntheticComparison(20), file);
  EXPECT_EQ(status.code(), StatusCode::kOutput);
  EXPECT_THAT(status.message(), HasSubstr("taken"));
}

TEST(Tables, GivenTheTerminalThenBestIsStarredAndEveryLostRunIsNamed) {
  const std::string text = FormatTable(test::SyntheticComparison(50));
  EXPECT_THAT(text, HasSubstr("*"));
  EXPECT_THAT(text, HasSubstr("po_invio_multi, the paper"));
  EXPECT_THAT(text, HasSubstr("vins_mono_class on V1_01_easy, seed 2: failed: cam0/tracks.csv:12"));
}

TEST(ReportData, GivenAColumnThenItUnpacksToItsResolutionAndKeepsGaps) {
  const std::vector<double> values = {0.1234, kNan, -2.5, 3.75, 3.7504};
  const PackedColumn column = PackColumn(values, 1e-3);
  ASSERT_EQ(column.deltas.size(), values.size());
  long long sum = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    sum += column.deltas[i].second;
    EXPECT_EQ(column.deltas[i].first, std::isfinite(values[i]));
    if (column.deltas[i].first) {
      EXPECT_NEAR(static_cast<double>(sum) * column.quantum, values[i], 0.51e-3);
    }
  }
  EXPECT_LE(PackColumn({1e-5, 2e-5}, 1e-3).quantum, 1e-8) << "small errors keep their digits";
  EXPECT_GE(PackColumn({1e14}, 1e-3).quantum * 1e15, 1e14) << "a diverged run fits a script's integers";
}

TEST(NeesOverTime, GivenRowsThatShowExtremesThenTheyAreInNoMean) {
  CellResult cell = Cell("a", 1, 0.1, 6);
  cell.series.time_s = {0, 1, 1.4, 2};
  cell.series.nees_pose = {6, 6, 900, 6};
  cell.series.regular = {true, true, false, true};
  EXPECT_THAT(AverageNees({&cell}).mean, ::testing::ElementsAre(6, 6, 6));
}

TEST(ReportJson, GivenAComparisonThenProgramsFindItsTables) {
  Comparison comparison = test::SyntheticComparison(50);
  comparison.notes = {"MH_05: its data is missing"};
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteTables(comparison, folder.path()).ok());
  const nlohmann::json json = nlohmann::json::parse(ReadFile(folder.File("report.json")));
  EXPECT_EQ(json["not_run"], nlohmann::json({"MH_05: its data is missing"}));
  EXPECT_EQ(json["estimators"], nlohmann::json({"po_invio_multi", "invio_l5", "vins_mono_class"}));
  EXPECT_EQ(json["cells"].size(), 12U);
  EXPECT_EQ(json["cells"][11]["status"], "failed");
  EXPECT_THAT(json["cells"][11]["message"].get<std::string>(), HasSubstr("</script>"));
  EXPECT_EQ(json["aggregate"][5]["ok"], 1);
  EXPECT_FALSE(json["cells"][0].contains("series"));
}

TEST(Report, GivenItThenItsPolicyAllowsOnlyItsOwnScripts) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteReport(test::SyntheticComparison(30), folder.File("report.html")).ok());
  const std::string page = ReadFile(folder.File("report.html"));
  const std::string start = "<meta http-equiv=\"Content-Security-Policy\" content=\"";
  const size_t found = page.find(start);
  ASSERT_NE(found, std::string::npos);
  EXPECT_LT(found, page.find("<link")) << "what comes before the policy is free of it";
  const std::string policy =
      page.substr(found + start.size(), page.find('"', found + start.size()) - found - start.size());
  EXPECT_THAT(policy, ::testing::MatchesRegex("default-src 'none'; script-src 'sha256-[^']{43}=' "
                                              "'sha256-[^']{43}='; style-src 'unsafe-inline'; img-src data:; "
                                              "base-uri 'none'; form-action 'none'"));
}

TEST(ReportData, GivenTextThatEndsScriptsThenTheDataCannot) {
  const std::string data = ReportData(test::SyntheticComparison(30));
  EXPECT_THAT(data, Not(HasSubstr("<")));
  EXPECT_THAT(data, HasSubstr("\\u003c/script>\\u003cb>"));
}

TEST(Report, GivenTenEstimatorsOnTenSequencesThenThePageStaysBelowFiveMegabytes) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteReport(test::LargeComparison(), folder.File("report.html")).ok());
  const size_t bytes = ReadFile(folder.File("report.html")).size();
  EXPECT_LT(bytes, 5'000'000U);
  EXPECT_GT(bytes, 3'000'000U) << "room that the curves could use";
}

TEST(Report, GivenTheSameComparisonThenTheSameBytes) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteReport(test::SyntheticComparison(30), folder.File("a.html")).ok());
  ASSERT_TRUE(WriteReport(test::SyntheticComparison(30), folder.File("b.html")).ok());
  EXPECT_EQ(ReadFile(folder.File("a.html")), ReadFile(folder.File("b.html")));
}

}  // namespace
}  // namespace alidade
