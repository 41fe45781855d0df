// The tables of a comparison on each run, and that they are the same bytes again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>
#include <vector>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

std::vector<std::string> Fields(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) {
    fields.push_back(field);
  }
  return fields;
}

/// Estimator -> column -> text, of summary.csv. Messages with commas are cut.
std::map<std::string, std::map<std::string, std::string>> Summary(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> header = Fields(line);
  std::map<std::string, std::map<std::string, std::string>> rows;
  while (std::getline(lines, line)) {
    const std::vector<std::string> fields = Fields(line);
    for (size_t i = 0; i < std::min(header.size(), fields.size()); ++i) {
      rows[fields[0]][header[i]] = fields[i];
    }
  }
  return rows;
}

class CompareReport : public testing::Test {
 protected:
  void WritePlan(const std::string& estimators) {
    folder_.Write("plan.yaml",
                  "set: {init.method: truth}\nestimators:\n" + estimators +
                      "sequences:\n  - {config: " + Source("configs/datasets/figure8_short.yaml") +
                      ", name: short, set: {duration_s: 5, path_m: 6.5}}\nmetrics: {rpe: [1]}\n");
  }
  [[nodiscard]] CommandResult Compare(const std::string& environment, const std::string& more) const {
    return Shell(environment + " " + std::string(ALIDADE_BINARY_DIR) + "/alidade compare --quiet --plan=" +
                 folder_.File("plan.yaml") + " --output=" + folder_.File("out") + " " + more);
  }
  [[nodiscard]] std::string Out(const std::string& file) const {
    return ReadFile(folder_.File("out/" + file));
  }
  [[nodiscard]] std::map<std::string, std::string> Tables() const {
    std::map<std::string, std::string> texts;
    for (const char* file : {"summary.csv", "aggregate.csv", "pairs.csv", "nees_over_time.csv", "tables.md",
                             "tables.tex", "report.json", "report.html"}) {
      texts[file] = Out(file);
      EXPECT_FALSE(texts[file].empty()) << file;
    }
    return texts;
  }
  test::TemporaryFolder folder_;
};

std::string Estimator(const std::string& name, const std::string& more = "") {
  return "  - {config: " + Source("configs/estimators/" + name + ".yaml") + more + "}\n";
}

// GIVEN a date from outside WHEN a comparison is resumed in parallel, or its tables are collected as a
// cluster's last job does, THEN every table is the same bytes, on any day.
TEST_F(CompareReport, TheSameRunsGiveTheSameBytes) {
  WritePlan(Estimator("po_invio_multi") + Estimator("po_invio_two"));
  const std::string evening = "SOURCE_DATE_EPOCH=1795651199";
  const CommandResult first = Compare(evening, "");
  ASSERT_EQ(first.code, 0) << first.output;
  const std::map<std::string, std::string> tables = Tables();
  EXPECT_THAT(tables.at("tables.md"), HasSubstr(", 2026-11-25 (UTC), on "));
  EXPECT_THAT(tables.at("report.html"), HasSubstr(", 2026-11-25 (UTC), on "));
  EXPECT_THAT(tables.at("report.json"), HasSubstr("\"date\": \"2026-11-25\""));
  for (const char* again : {"--resume --jobs=2", "--stage=tables"}) {
    const CommandResult repeated = Compare(evening, again);
    ASSERT_EQ(repeated.code, 0) << repeated.output;
    for (const auto& [file, text] : tables) {
      EXPECT_TRUE(Out(file) == text) << file << " differs after " << again;
    }
  }
  ASSERT_EQ(Compare("SOURCE_DATE_EPOCH=1795651200", "--resume").code, 0);
  EXPECT_THAT(Out("tables.md"), HasSubstr(", 2026-11-26 (UTC), on "));
}

TEST_F(CompareReport, ADateThatIsNoneIsRefusedBeforeAnythingRuns) {
  WritePlan(Estimator("po_invio_multi"));
  const CommandResult result = Compare("SOURCE_DATE_EPOCH=today", "");
  EXPECT_EQ(result.code, 2) << result.output;
  EXPECT_THAT(result.output,
              HasSubstr("SOURCE_DATE_EPOCH: found \"today\", expected whole seconds since 1970"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("out/cells")));
}

// GIVEN runs of ours and of a program that ended well, never began, failed, and stopped halfway WHEN compared
// THEN each shows how much it completed, how fast it was and whether it uses later data.
TEST_F(CompareReport, EveryRunHasCompletionSpeedAndMode) {
  const std::string half =
      "awk -F, '!/#/ && n++ < 251 {printf \"%.9f %s %s %s %s %s %s %s\\n\", $1/1e9, $2, $3, $4, $6, $7, $8, "
      "$5}' "
      "$1/mav0/state_groundtruth_estimate0/data.csv > $2/trajectory.tum\n";
  const std::string program = folder_.Write("half.sh", half);
  const std::string call = "command: 'sh " + program + " {dataset} {output}";
  WritePlan(Estimator("po_invio_multi") + Estimator("batch") +
            Estimator("po_invio_two", ", name: moving, set: {init.method: static}") +
            "  - {name: broken, command: 'exit 4'}\n"
            "  - {name: half, mode: smoothed, " +
            call +
            "'}\n"
            "  - {name: timed, " +
            call +
            " && printf \"timestamp_ns,frontend_ms,backend_ms\\n0,20,5\\n400000000,20,5\\n\" > "
            "{output}/timing.csv'}\n");
  const CommandResult result = Compare("", "");
  EXPECT_EQ(result.code, 7) << result.output;
  const auto rows = Summary(Out("summary.csv"));
  const auto number = [&rows](const std::string& estimator, const std::string& column) {
    const std::string& text = rows.at(estimator).at(column);
    return text.empty() ? -1 : std::stod(text);
  };
  EXPECT_EQ(rows.at("moving").at("status"), "not_initialized");
  for (const auto& [estimator, completion] : std::map<std::string, double>{{"po_invio_multi", 1},
                                                                           {"batch", 1},
                                                                           {"moving", 0},
                                                                           {"broken", 0},
                                                                           {"half", 0.5},
                                                                           {"timed", 0.5}}) {
    EXPECT_NEAR(number(estimator, "completion"), completion, 0.06) << estimator;
    const bool smoothed = estimator == "batch" || estimator == "half";
    EXPECT_EQ(rows.at(estimator).at("mode"), smoothed ? "smoothed" : "causal") << estimator;
  }
  const double frame_ms = number("po_invio_multi", "backend_ms");
  EXPECT_NEAR(number("po_invio_multi", "realtime_factor") * frame_ms,
              1e3 * 5 / number("po_invio_multi", "frames"),
              0.03 * 1e3 * 5 / number("po_invio_multi", "frames"));
  EXPECT_NEAR(number("timed", "realtime_factor"), 8, 1e-9) << "0.4 s of data in 50 ms";
  EXPECT_GT(number("half", "realtime_factor"), 0) << "of the whole program";
  EXPECT_EQ(number("moving", "realtime_factor"), -1);
  EXPECT_THAT(Out("tables.md"), HasSubstr("Smoothed: uses later data (batch, half), which"));
}

}  // namespace
}  // namespace alidade::test
