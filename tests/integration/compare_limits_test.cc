#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

const std::string kShort = "{config: " + Source("configs/datasets/figure8_short.yaml") +
                           ", name: short, set: {duration_s: 5, path_m: 6.5}";

class CompareLimits : public testing::Test {
 protected:
  void WritePlan(const std::string& estimators, const std::string& sequences) {
    folder_.Write("plan.yaml", "set: {init.method: truth}\nmetrics: {rpe: [1]}\nestimators: [" +
                                   Source("configs/estimators/po_invio_multi.yaml") + estimators +
                                   "]\nsequences: [" + sequences + "]\n");
  }
  [[nodiscard]] std::string Words(const std::string& more) const {
    return std::string(ALIDADE_BINARY_DIR) + "/alidade compare --quiet --plan=" + folder_.File("plan.yaml") +
           " --output=" + folder_.File("out") + " " + more;
  }
  [[nodiscard]] std::string Out(const std::string& file) const {
    return ReadFile(folder_.File("out/" + file));
  }
  test::TemporaryFolder folder_;
};

// GIVEN a limit of time WHEN a cell of ours stands still and a command never ends, nor what it has left in
// the background, THEN both have failed with the reason, nothing of them lives on, and the others are there.
TEST_F(CompareLimits, ACellThatHangsIsEnded) {
  WritePlan(
      ", {name: theirs, command: 'setsid sleep 3000 & echo $! > {output}/pid; sleep 3000', sequences: "
      "[short]}",
      kShort + ", seeds: 1..2}, {config: " + Source("configs/datasets/figure8_short.yaml") +
          ", name: stopped, set: {duration_s: 60, path_m: 78}}");
  const CommandResult result =
      Shell("exec 2>&1; OUT=" + folder_.File("out") + "; " + Words("--jobs=3 --cell_time_limit_s=8") +
            " & main=$!; mark=$OUT/scores/po_invio_multi/stopped/1.cbor.running"
            "; until test -s $mark; do sleep 0.01; done; kill -STOP $(cut -d' ' -f2 $mark); wait $main; echo "
            "code $?"
            // Dead, though nobody may have waited for it yet.
            "; pid=$(cat $OUT/cells/theirs/short/1/pid); for i in $(seq 100); do if ! test -e /proc/$pid || "
            "grep -q "
            "'^State:.Z' /proc/$pid/status; then echo it is gone; break; fi; sleep 0.1; done");
  EXPECT_THAT(result.output, HasSubstr("3 of 5 cells failed"));
  EXPECT_THAT(result.output, HasSubstr("code 7"));
  EXPECT_THAT(result.output, HasSubstr("it is gone"));
  const std::string summary = Out("summary.csv");
  EXPECT_THAT(summary, HasSubstr("po_invio_multi,filter,short,1,ok,"));
  EXPECT_THAT(summary, HasSubstr("po_invio_multi,filter,short,2,ok,"));
  EXPECT_THAT(summary, HasSubstr("po_invio_multi,filter,stopped,1,failed,"));
  EXPECT_THAT(Out("tables.md"), HasSubstr("took longer than 8 s"));
  const std::string status = Shell(Words("--status=" + folder_.File("out"))).output;
  EXPECT_THAT(status, HasSubstr("5 of 5 cells are complete, 3 of them failed, 0 run"));
  EXPECT_THAT(status, HasSubstr("theirs/short/2: failed, took longer than 8 s (--cell_time_limit_s)"));
}

// GIVEN a limit of memory WHEN a command and a cell of ours take more, in one process or as a task of a
// cluster does it, THEN they have failed with the reason, and the others are there.
TEST_F(CompareLimits, ACellThatTakesAllMemoryIsEnded) {
  WritePlan(", {name: theirs, command: 'tail /dev/zero', sequences: [short]}",
            kShort + "}, {config: " + Source("configs/datasets/figure8_short.yaml") +
                ", name: long, set: {duration_s: 2000, path_m: 2600}}");
  const std::string limit = "--cell_memory_limit_mib=250 ";
  const auto expect_reported = [](const std::string& text) {
    for (const char* cell : {"theirs/short/1", "po_invio_multi/long/1"}) {
      EXPECT_THAT(text, HasSubstr(std::string(cell) +
                                  ": failed, took more than 250 MiB of memory (--cell_memory_limit_mib)"));
    }
    EXPECT_THAT(text, HasSubstr("3 of 3 cells are complete, 2 of them failed, 0 run"));
  };
  const CommandResult whole = Shell(Words(limit));
  EXPECT_EQ(whole.code, 7) << whole.output;
  EXPECT_THAT(Out("summary.csv"), HasSubstr("po_invio_multi,filter,short,1,ok,"));
  expect_reported(Shell(Words("--status=" + folder_.File("out"))).output);

  std::filesystem::remove_all(folder_.File("out/scores"));  // cells.csv stays, as where tasks begin
  EXPECT_EQ(Shell(Words(limit + "--stage=cells")).code, 0);
  expect_reported(Shell(Words("--status=" + folder_.File("out"))).output);
  EXPECT_EQ(Shell(Words(limit + "--stage=tables")).code, 7);
  EXPECT_THAT(Out("summary.csv"), HasSubstr("po_invio_multi,filter,short,1,ok,"));
}

TEST_F(CompareLimits, ALimitBelowZeroIsRefused) {
  WritePlan("", kShort + "}");
  const CommandResult result = Shell(Words("--cell_time_limit_s=-1"));
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.output, HasSubstr("--cell_time_limit_s: found -1, expected 0 (none) or more"));
}

// GIVEN a worker that hangs WHEN the comparison is interrupted THEN it still ends.
TEST_F(CompareLimits, AnInterruptionDoesNotWaitForACellThatHangs) {
  WritePlan("", "{config: " + Source("configs/datasets/figure8_short.yaml") +
                    ", name: stopped, set: {duration_s: 60, path_m: 78}}");
  const CommandResult result =
      Shell("exec 2>&1; " + Words("") + " & main=$!; mark=" + folder_.File("out") +
            "/scores/po_invio_multi/stopped/1.cbor.running; until test -s $mark; do sleep 0.01; done"
            "; worker=$(cut -d' ' -f2 $mark); kill -STOP $worker; kill -TERM $main; wait $main"
            "; echo code $?; kill -0 $worker");
  EXPECT_THAT(result.output, HasSubstr("code 130"));
  EXPECT_THAT(result.output, HasSubstr("No such process"));
}

}  // namespace
}  // namespace alidade::test
