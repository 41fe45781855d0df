// One whole comparison: its results, and the runs it is made of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/integration/compare_fixture.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

TEST_F(CompareCommand, ResultsDoNotDependOnTheNumberOfJobs) {
  const CommandResult one = Compare("one", "--figures=svg");
  ASSERT_EQ(one.code, 0) << one.output;
  ASSERT_EQ(Compare("two", "--jobs=3 --figures=svg").code, 0);
  EXPECT_EQ(ComparableFiles(folder_.File("one/cells")), ComparableFiles(folder_.File("two/cells")));
  const std::string summary = WithoutTimes(ReadFile(folder_.File("one/summary.csv")));
  EXPECT_THAT(summary, HasSubstr("alidade_filter,filter,short,2,ok,"));
  EXPECT_EQ(summary, WithoutTimes(ReadFile(folder_.File("two/summary.csv"))));
  EXPECT_EQ(WithoutTimes(ReadFile(folder_.File("one/aggregate.csv"))),
            WithoutTimes(ReadFile(folder_.File("two/aggregate.csv"))));
  for (const char* file : {"pairs.csv", "nees_over_time.csv", "figures/short_trajectory.svg",
                           "figures/short_position_error.svg", "figures/short_nees.svg"}) {
    const std::string text = ReadFile(folder_.File(std::string("one/") + file));
    EXPECT_THAT(text, testing::AnyOf(HasSubstr("short,"), HasSubstr("<svg"))) << file;
    EXPECT_EQ(text, ReadFile(folder_.File(std::string("two/") + file))) << file;
  }
  for (const char* file : {"aggregate.csv", "tables.md", "tables.tex", "report.html", "report.json"}) {
    EXPECT_FALSE(ReadFile(folder_.File(std::string("one/") + file)).empty()) << file;
  }
}

TEST_F(CompareCommand, AnUnknownFormatOfFiguresIsRefusedBeforeAnythingRuns) {
  const CommandResult wrong = Compare("out", "--figures=png");
  EXPECT_EQ(wrong.code, 2) << wrong.output;
  EXPECT_THAT(wrong.output, HasSubstr("compare: --figures: found \"png\", expected svg, pdf or svg,pdf"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("out")));
}

// GIVEN a sequence with settings for the estimators WHEN compared THEN they hold there and only there.
TEST_F(CompareCommand, ASequenceMaySetItsOwnNoise) {
  folder_.Write("plan.yaml",
                "set: {init.method: truth}\nestimators: [" +
                    Source("configs/estimators/po_invio_multi.yaml") +
                    "]\nsequences:\n  - {config: " + Source("configs/datasets/figure8_short.yaml") +
                    ", name: plain, set: {duration_s: 5, path_m: 6.5}}\n  - {config: " +
                    Source("configs/datasets/figure8_short.yaml") +
                    ", name: loud, set: {duration_s: 5, path_m: 6.5}, estimator_set: {vision.pixel_noise_px: "
                    "2}}\n");
  const CommandResult result = Compare("out");
  ASSERT_EQ(result.code, 0) << result.output;
  const std::string cells = "out/cells/po_invio_multi/";
  EXPECT_THAT(ReadFile(folder_.File(cells + "plain/1/run.json")), HasSubstr("\"pixel_noise_px\": 1"));
  EXPECT_THAT(ReadFile(folder_.File(cells + "loud/1/run.json")), HasSubstr("\"pixel_noise_px\": 2"));
}

TEST_F(CompareCommand, FailedCellDoesNotStopTheOthers) {
  folder_.Write("plan.yaml",
                "estimators:\n"
                "  - {config: " +
                    Source("configs/estimators/alidade_filter.yaml") +
                    ", name: moving, set: {init.method: static}}\n"
                    "  - {config: " +
                    Source("configs/estimators/alidade_filter.yaml") +
                    ", name: good, set: {init.method: truth}}\n"
                    "sequences:\n"
                    "  - {config: " +
                    Source("configs/datasets/figure8_short.yaml") + ", set: {duration_s: 5, path_m: 6.5}}\n");
  const CommandResult result = Compare("out");
  EXPECT_EQ(result.code, 7) << result.output;
  const std::string summary = ReadFile(folder_.File("out/summary.csv"));
  EXPECT_THAT(summary, HasSubstr("moving,filter,figure8_short,1,not_initialized,"));
  EXPECT_THAT(summary, HasSubstr("good,filter,figure8_short,1,ok,"));
  EXPECT_THAT(ReadFile(folder_.File("out/tables.md")),
              HasSubstr("- moving on figure8\\_short, seed 1: not\\_initialized"));
  EXPECT_THAT(ReadFile(folder_.File("out/pairs.csv")),
              HasSubstr("figure8_short,rmse_pos_m,moving,good,0,0,1,0,"));
}

// An external program that is given the truth, as a command: it finds its input, is timed and scored like all
// others.
TEST_F(CompareCommand, ACommandIsRunTimedScoredAndKept) {
  const std::string script = folder_.Write(
      "program.sh",
      "set -e\ntest -s $1/mav0/imu0/data.csv\ntest -s $3\nsleep 0.3\n[ -z \"$4\" ] || echo ran >> " +
          folder_.File("runs") +
          "\nawk -F, '!/#/{printf \"%.9f %s %s %s %s %s %s %s\\n\", $1/1e9, $2+1, $3, $4, $6, $7, $8, $5}' "
          "$1/mav0/state_groundtruth_estimate0/data.csv > $2/out.txt\n");
  const std::string plan = folder_.Write(
      "external.yaml",
      "estimators:\n  - {name: theirs, command: 'sh " + script +
          " {dataset} {output} {bag} note', result: out.txt}\n"
          "  - {name: timed, program: " +
          script +
          ", command: 'sh {program} {dataset} {output} {bag} && printf "
          "\"frontend_ms,backend_ms\\\\n1.5,2\\\\n2.5,4\\\\n\" > {output}/timing.csv', result: out.txt}\n"
          "  - {name: gone, program: none, command: '{program}'}\n"
          "  - {name: broken, command: 'echo no luck; exit 4'}\n"
          "sequences:\n  - {config: " +
          Source("configs/datasets/figure8_short.yaml") +
          ", name: short, set: {duration_s: 5, path_m: 6.5}}\nmetrics: {align: none, rpe: [1]}\n");
  const auto compare = [&](const std::string& more) {
    return Alidade("compare --quiet --plan=" + plan + " --output=" + folder_.File("out") + " " + more);
  };
  const CommandResult first = compare("");
  EXPECT_EQ(first.code, 7) << first.output;
  EXPECT_THAT(first.output, HasSubstr("code 4: no luck"));
  const std::string summary = ReadFile(folder_.File("out/summary.csv"));
  EXPECT_THAT(summary, HasSubstr("theirs,external,short,1,ok,"));
  EXPECT_THAT(summary, testing::ContainsRegex("timed,external,short,1,ok,.*,2,3,4,"));
  EXPECT_THAT(ReadFile(folder_.File("out/tables.md")), HasSubstr("gone: its program is missing, expected "));
  // One metre off along x, whatever is printed of it.
  EXPECT_THAT(summary, testing::ContainsRegex(",(1|1\\.0000000[0-9]*|0\\.9999999[0-9]*),"));
  EXPECT_THAT(ReadFile(folder_.File("out/cells/theirs/short/1/external.json")), HasSubstr("\"wall_s\": "));
  EXPECT_EQ(compare("--resume").code, 7);
  EXPECT_EQ(ReadFile(folder_.File("runs")), "ran\n") << "resumed, it is not run again";
}

}  // namespace
}  // namespace alidade::test
