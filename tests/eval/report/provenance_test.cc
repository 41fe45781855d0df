// Who made the tables, and which estimators use later data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "eval/report/report.h"
#include "eval/report/tables.h"
#include "eval/report/tables_terminal.h"
#include "tests/eval/report/synthetic_comparison.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::ReadFile;
using ::testing::HasSubstr;
using ::testing::Not;

class ProvenanceOfTables : public ::testing::Test {
 protected:
  void SetUp() override {
    comparison_ = test::SyntheticComparison(30);
    comparison_.provenance = {"1.2.3", "2026-11-25", {"Fast & <Small>", 4}};
  }
  std::string Written(const std::string& file) {
    EXPECT_TRUE(WriteTables(comparison_, folder_.path()).ok());
    EXPECT_TRUE(WriteReport(comparison_, folder_.File("report.html")).ok());
    return ReadFile(folder_.File(file));
  }
  nlohmann::json Json() { return nlohmann::json::parse(Written("report.json")); }
  void Smooth(const std::string& estimator) {
    for (CellResult& cell : comparison_.cells) {
      cell.smoothed = cell.estimator == estimator;
    }
  }

  const test::TemporaryFolder folder_;
  Comparison comparison_;
};

TEST_F(ProvenanceOfTables, GivenItThenEveryReportHoldsVersionDateAndMachine) {
  EXPECT_THAT(
      Written("tables.md"),
      HasSubstr("\nMade with Alidade 1.2.3, 2026-11-25 (UTC), on Fast & \\<Small\\> (4 logical cores).\n"));
  EXPECT_THAT(Written("tables.tex"),
              HasSubstr("% Alidade 1.2.3, 2026-11-25 (UTC), on Fast \\& <Small> (4 logical cores)\n"));
  EXPECT_THAT(Written("report.html"),
              HasSubstr("Alidade 1.2.3, 2026-11-25 (UTC), on Fast &amp; &lt;Small&gt; (4 logical cores)"));
  const nlohmann::json json = Json();
  EXPECT_EQ(json["version"], "1.2.3");
  EXPECT_EQ(json["date"], "2026-11-25");
  EXPECT_EQ(json["machine"], nlohmann::json({{"cpu", "Fast & <Small>"}, {"cores", 4}}));
  EXPECT_EQ(json["command"], comparison_.command);
}

TEST_F(ProvenanceOfTables, GivenNoneThenNothingIsClaimed) {
  comparison_.provenance = {};
  EXPECT_THAT(Written("tables.md"), Not(HasSubstr("Made with")));
}

TEST_F(ProvenanceOfTables, GivenASmoothedEstimatorThenItIsMarkedWhereverItStands) {
  Smooth("invio_l5");
  const std::string markdown = Written("tables.md");
  EXPECT_THAT(markdown, HasSubstr("| invio\\_l5 (smoothed) | 2/2 |"));  // of a sequence
  EXPECT_THAT(markdown, HasSubstr("| po\\_invio\\_multi | 2/2 |"));
  EXPECT_THAT(markdown, HasSubstr("Smoothed: uses later data (invio\\_l5), which"));
  EXPECT_THAT(markdown, HasSubstr("| row is ... than column | po\\_invio\\_multi | invio\\_l5 (smoothed) |"));
  EXPECT_THAT(markdown, HasSubstr("| sequence | po\\_invio\\_multi | invio\\_l5 (smoothed) |"));  // of a map
  const size_t overview = markdown.find("## Overview");
  ASSERT_NE(overview, std::string::npos);
  EXPECT_LT(markdown.find("| invio\\_l5 (smoothed) |", overview), markdown.find("| runs ok |"));
  EXPECT_THAT(Written("tables.tex"), HasSubstr("{invio\\_l5 (smoothed)} & {2/2}"));
  EXPECT_THAT(FormatTable(comparison_), HasSubstr("Smoothed: uses later data (invio_l5), which"));
  EXPECT_THAT(Written("summary.csv"), HasSubstr(",smoothed,\n"));
  const nlohmann::json json = Json();
  for (const nlohmann::json& row : json["aggregate"]) {
    EXPECT_EQ(row["mode"], row["estimator"] == "invio_l5" ? "smoothed" : "causal");
  }
  EXPECT_EQ(json["cells"][1]["mode"], "smoothed");
}

TEST_F(ProvenanceOfTables, GivenCausalEstimatorsThenNoneIsMarked) {
  EXPECT_THAT(Written("tables.md"), Not(HasSubstr("moothed:")));
  EXPECT_THAT(FormatTable(comparison_), Not(HasSubstr("moothed:")));
}

TEST_F(ProvenanceOfTables, GivenALostRunThenItsCompletionIsInTheTables) {
  CellResult& lost = comparison_.cells.front();
  lost.status = "diverged";
  lost.completion = 0.5;
  const std::string markdown = Written("tables.md");
  EXPECT_THAT(markdown, HasSubstr("| completed | x real time \\[s/s\\] |"));
  EXPECT_THAT(markdown, HasSubstr(" 0.740 \u00b1 0.240")) << "of 0.5 and 0.98";
  const nlohmann::json json = Json();
  EXPECT_EQ(json["figures"].back()["key"], "realtime_factor");
  EXPECT_EQ(json["figures"][json["figures"].size() - 2]["all_runs"], true);
}

}  // namespace
}  // namespace alidade
