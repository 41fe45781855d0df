// A comparison in pieces: resumed, interrupted, or run part by part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tests/integration/compare_fixture.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

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
// prints its progress, a second comparison into the folder is refused, and a resumed one ends as if nothing
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
  // A stage writes what there is to do, and tables of a comparison none of whose cells has run: they have all
  // failed.
  const CommandResult tables = Compare("out", "--stage=tables");
  EXPECT_EQ(tables.code, 7) << tables.output;
  EXPECT_EQ(Alidade("compare --status=" + folder_.File("out")).code, 0);
}

// GIVEN the parts of a comparison run one by one, as the tasks of a cluster do WHEN the tables are collected
// THEN they are those of one run.
TEST_F(CompareCommand, PartsMakeTheWhole) {
  ASSERT_EQ(Compare("whole").code, 0);
  for (const char* part : {"2/3", "0/3", "1/3", "1/3"}) {
    ASSERT_EQ(Compare("parts", std::string("--stage=cells --part=") + part).code, 0);
  }
  EXPECT_EQ(ReadFile(folder_.File("parts/cells.csv")), ReadFile(folder_.File("whole/cells.csv")));
  EXPECT_THAT(Alidade("compare --status=" + folder_.File("parts")).output,
              HasSubstr("0 of them failed, 0 run"));
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

}  // namespace
}  // namespace alidade::test
