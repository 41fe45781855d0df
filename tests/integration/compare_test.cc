#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

/// Rows of a CSV file without the columns of measured times.
std::string WithoutTimes(const std::string& text) {
  std::istringstream lines(text);
  std::vector<bool> keep;
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    size_t column = 0;
    for (std::string field; std::getline(fields, field, ','); ++column) {
      if (result.empty() || keep.size() == column) {
        keep.push_back(field.find("_ms") == std::string::npos && !field.starts_with("realtime_factor"));
      }
      result += keep[column] ? field + "," : "";
    }
    result += "\n";
  }
  return result;
}

class CompareCommand : public testing::Test {
 protected:
  void SetUp() override {
    plan_ = folder_.Write("plan.yaml",
                          "set: {init.method: truth}\n"
                          "estimators:\n"
                          "  - " +
                              Source("configs/estimators/alidade_filter.yaml") +
                              "\n"
                              "  - " +
                              Source("configs/estimators/vins_mono_class.yaml") +
                              "\n"
                              "sequences:\n"
                              "  - {config: " +
                              Source("configs/datasets/figure8_short.yaml") +
                              ", name: short, set: {duration_s: 5, path_m: 6.5}, seeds: 1..2}\n"
                              "metrics: {rpe: [1, 2]}\n");
  }
  CommandResult Compare(const std::string& output, const std::string& more = "") const {
    return Alidade("compare --quiet --plan=" + plan_ + " --output=" + folder_.File(output) + " " + more);
  }
  test::TemporaryFolder folder_;
  std::string plan_;
};

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

// GIVEN a comparison with one cell gone and one torn WHEN it is resumed THEN those two run again, the others
// are not touched, and the tables are those of the first time.
TEST_F(CompareCommand, ResumeRunsOnlyWhatIsMissing) {
  ASSERT_EQ(Compare("out").code, 0);
  const std::string summary = ReadFile(folder_.File("out/summary.csv"));
  const std::string kept = folder_.File("out/cells/alidade_filter/short/1/run.json");
  const std::string kept_text = ReadFile(kept);
  const auto kept_time = std::filesystem::last_write_time(kept);
  std::filesystem::remove_all(folder_.File("out/cells/alidade_filter/short/2"));
  folder_.Write("out/cells/vins_mono_class/short/1/run.json", "{");
  EXPECT_EQ(Compare("out").code, 6);  // neither --resume nor --overwrite
  const CommandResult resumed = Compare("out", "--resume");
  ASSERT_EQ(resumed.code, 0) << resumed.output;
  EXPECT_EQ(ReadFile(kept), kept_text);
  EXPECT_EQ(std::filesystem::last_write_time(kept), kept_time);
  EXPECT_EQ(WithoutTimes(ReadFile(folder_.File("out/summary.csv"))), WithoutTimes(summary));
}

// GIVEN a comparison that runs WHEN one of its workers is killed THEN that costs the cell it was at, --status
// tells how far it is, a second comparison into the folder is refused, and a resumed one ends as if nothing
// had been.
TEST_F(CompareCommand, AWorkerThatDiesCostsItsCellAlone) {
  folder_.Write("plan.yaml",
                "set: {init.method: truth}\nestimators: [" +
                    Source("configs/estimators/po_invio_multi.yaml") + ", " +
                    Source("configs/estimators/vins_mono_class.yaml") +
                    "]\nsequences:\n  - {config: " + Source("configs/datasets/figure8_short.yaml") +
                    ", name: short, set: {duration_s: 12, path_m: 15.6}, seeds: 1..3}\n");
  ASSERT_EQ(Compare("clean").code, 0);
  const std::string program = std::string(ALIDADE_BINARY_DIR) + "/alidade";
  const CommandResult killed =
      Shell("exec 2>&1; export ALIDADE=" + program + " OUT=" + folder_.File("out") + " PLAN=" + plan_ +
            "; $ALIDADE compare --plan=$PLAN --output=$OUT --quiet & main=$!"
            "; until ls $OUT/scores/vins_mono_class/short/1.cbor.running 2>/dev/null; do sleep 0.02; done"
            "; $ALIDADE compare --plan=$PLAN --output=$OUT --resume --quiet; echo second $?"
            "; $ALIDADE compare --status=$OUT"
            "; kill -9 $(pgrep -P $main); wait $main; echo main $?");
  EXPECT_THAT(killed.output, HasSubstr("another process is writing there"));
  EXPECT_THAT(killed.output, HasSubstr("second 6"));
  EXPECT_THAT(killed.output, HasSubstr("1 of 6 cells are complete, 0 of them failed, 1 run"));
  EXPECT_THAT(killed.output, HasSubstr("vins_mono_class/short/1: running on "));
  EXPECT_THAT(killed.output, HasSubstr("1 of 6 cells failed"));
  EXPECT_THAT(killed.output, HasSubstr("main 7"));
  EXPECT_THAT(ReadFile(folder_.File("out/summary.csv")),
              HasSubstr("vins_mono_class,smoother,short,1,failed,"));
  EXPECT_THAT(ReadFile(folder_.File("out/tables.md")), HasSubstr("its process ended with signal 9"));

  ASSERT_EQ(Compare("out", "--resume").code, 0);
  EXPECT_EQ(ComparableFiles(folder_.File("out/cells")), ComparableFiles(folder_.File("clean/cells")));
  EXPECT_EQ(WithoutTimes(ReadFile(folder_.File("out/summary.csv"))),
            WithoutTimes(ReadFile(folder_.File("clean/summary.csv"))));
  EXPECT_THAT(Alidade("compare --status=" + folder_.File("out")).output,
              HasSubstr("6 of 6 cells are complete, 0 of them failed, 0 run"));
}

TEST_F(CompareCommand, StagesAndStatusRefuseWhatTheyCannotDo) {
  for (const auto& [words, message] : std::vector<std::pair<std::string, std::string>>{
           {"--stage=cels", "did you mean 'cells'"},
           {"--engine=slurn", "did you mean 'slurm'"},
           {"--stage=cells --part=3/3", "--part: found \"3/3\", expected K/N"},
           {"--stage=cells --part=x", "--part: found \"x\""}}) {
    const CommandResult result = Compare("out", words);
    EXPECT_EQ(result.code, 2) << words;
    EXPECT_THAT(result.output, HasSubstr(message));
  }
  const CommandResult none = Alidade("compare --status=" + folder_.File("none"));
  EXPECT_EQ(none.code, 4);
  EXPECT_THAT(none.output, HasSubstr("no comparison has begun there"));
  // Tables of a comparison none of whose cells has run: they have all failed.
  const CommandResult tables = Compare("out", "--stage=tables");
  EXPECT_EQ(tables.code, 7) << tables.output;
}

// GIVEN the parts of a comparison run one by one, as the tasks of a cluster do WHEN the tables are collected
// THEN they are those of one run.
TEST_F(CompareCommand, PartsMakeTheWhole) {
  ASSERT_EQ(Compare("whole").code, 0);
  for (const char* part : {"2/3", "0/3", "1/3", "1/3"}) {
    ASSERT_EQ(Compare("parts", std::string("--stage=cells --part=") + part).code, 0);
  }
  ASSERT_EQ(Compare("parts", "--stage=tables").code, 0);
  EXPECT_EQ(ComparableFiles(folder_.File("parts/cells")), ComparableFiles(folder_.File("whole/cells")));
  EXPECT_EQ(WithoutTimes(ReadFile(folder_.File("parts/summary.csv"))),
            WithoutTimes(ReadFile(folder_.File("whole/summary.csv"))));
}

// GIVEN the parts of a comparison WHEN the plan asks for other metrics THEN the reports of before do not
// enter its tables, and the cells run again.
TEST_F(CompareCommand, PartsOfAnotherPlanAreNotTaken) {
  ASSERT_EQ(Compare("parts", "--stage=cells").code, 0);
  ASSERT_EQ(Compare("parts", "--stage=tables").code, 0);
  std::string text = ReadFile(plan_);
  text.replace(text.find("rpe: [1, 2]"), 11, "rpe: [3]   ");
  folder_.Write("plan.yaml", text);
  const CommandResult stale = Compare("parts", "--stage=tables");
  EXPECT_EQ(stale.code, 7);
  EXPECT_THAT(stale.output, HasSubstr("of another plan or configuration"));
  ASSERT_EQ(Compare("parts", "--stage=cells").code, 0);
  EXPECT_EQ(Compare("parts", "--stage=tables").code, 0);
  EXPECT_THAT(ReadFile(folder_.File("parts/summary.csv")), HasSubstr("rpe_3"));
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

TEST_F(CompareCommand, AuditedPlanRunsAgainWhatWasNotAuditedAndReportsTheFilterAlone) {
  ASSERT_EQ(Compare("out").code, 0);
  folder_.Write("plan.yaml", "audit: true\n" + ReadFile(plan_));
  const CommandResult audited = Compare("out", "--resume");
  ASSERT_EQ(audited.code, 0) << audited.output;
  EXPECT_TRUE(std::filesystem::exists(folder_.File("out/cells/alidade_filter/short/1/observability.csv")));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("out/cells/vins_mono_class/short/1/observability.csv")));
  const std::string report = ReadFile(folder_.File("out/report.html"));
  EXPECT_THAT(report, HasSubstr("\"yaw_leak\":[1e-12,"));
  EXPECT_THAT(report, HasSubstr("\"yaw_leak\":[]"));
}

// GIVEN runs that started from a truth WHEN another one stands in its place, or the audit is not asked for
// any more, THEN they run again.
TEST_F(CompareCommand, ResumeKeepsNoRunOfAnotherTruthNorAnAuditedOne) {
  const std::string sequence = folder_.File("sequence");
  ASSERT_EQ(Alidade("simulate --quiet --set=duration_s=5,path_m=6.5 --config=" +
                    Source("configs/datasets/figure8_short.yaml") + " --output=" + sequence)
                .code,
            0);
  std::string truth = ReadFile(sequence + "/mav0/state_groundtruth_estimate0/data.csv");
  const std::string truth_path = folder_.Write("truth.csv", truth);
  const std::string plan = "estimators:\n  - {config: " + Source("configs/estimators/alidade_filter.yaml") +
                           ", name: ours, set: {init.method: truth}}\nsequences:\n  - {path: " + sequence +
                           ", name: short, truth: " + truth_path + "}\n";
  folder_.Write("plan.yaml", "audit: true\n" + plan);
  ASSERT_EQ(Compare("out").code, 0);
  const std::string cell = folder_.File("out/cells/ours/short/1/");
  const std::string first = ReadFile(cell + "run.json");
  EXPECT_THAT(first, HasSubstr("\"truth_digest\": "));
  ASSERT_EQ(Compare("out", "--resume").code, 0);
  EXPECT_EQ(ReadFile(cell + "run.json"), first);
  truth.resize(truth.rfind('\n', truth.size() - 2) + 1);  // without its last row
  folder_.Write("truth.csv", truth);
  ASSERT_EQ(Compare("out", "--resume").code, 0);
  EXPECT_NE(ReadFile(cell + "run.json"), first);
  EXPECT_TRUE(std::filesystem::exists(cell + "observability.csv"));
  folder_.Write("plan.yaml", plan);
  ASSERT_EQ(Compare("out", "--resume").code, 0);
  EXPECT_FALSE(std::filesystem::exists(cell + "observability.csv"));
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

// An external program that knows the truth, as a command: it finds its input, is timed and scored like all
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
