#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

// What scripts/fix_acceptance.sh makes of the tables of `alidade gnss_study`; a program that prints them
// stands in for Alidade. The runs themselves take minutes.

namespace alidade {
namespace {

using test::CommandResult;
using test::Source;
using testing::HasSubstr;

struct Row {
  std::string aligned = "12 of 12";
  std::string after_s = "5.9, 7.1";
  std::string nees = "3.90";
};

class FixAcceptanceTest : public testing::Test {
 protected:
  /// The script's answer when the last row is `last`; `others`: rows before it; `compared`: exit code of
  /// the comparison. The program fails in another locale than C.
  CommandResult Check(const Row& last, int others = 3, int compared = 0) const {
    std::string table =
        "| sequence | estimator | runs aligned | after [s], mean, worst | RMSE [m] | worst [m] | to the "
        "first "
        "sequence | single points [m] | last third to first | NEES position | its band |\n"
        "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    for (int i = 0; i < others; ++i) {
      table += Line(Row());
    }
    table += Line(last) + "\n| metre | `filter` | 0.7 | – | – | – | – | 0.1 | 0.2 | 9 of 12 | 0.1 | 0.2 |\n";
    const std::string program = folder_.Write(
        "alidade", "#!/bin/sh\n[ \"$LC_ALL\" = C ] || exit 9\n[ \"$1\" = gnss_study ] || exit " +
                       std::to_string(compared) + "\ncat '" + folder_.Write("table.md", table) + "'\n");
    return test::Shell("chmod +x " + program + " && LC_ALL=C.UTF-8 ALIDADE=" + program + " " +
                       Source("scripts/fix_acceptance.sh") + " " + folder_.File("out"));
  }

  static std::string Line(const Row& row) {
    return "| metre | `filter` | " + row.aligned + " | " + row.after_s +
           " | 0.705 ± 0.040 | 0.90 | 1.00 | – | 1.10 | " + row.nees + " | 1.78 to 4.54 |\n";
  }

  test::TemporaryFolder folder_;
};

TEST_F(FixAcceptanceTest, GIVEN_runs_that_meet_every_bound_THEN_it_exits_with_zero) {
  const CommandResult result = Check({});
  EXPECT_EQ(result.code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("aligned 12 of 12, the last after  7.1 s (at most 15 s); NEES 3.90 "
                                       "(1.78 to 4.54): met"));
}

TEST_F(FixAcceptanceTest, GIVEN_a_bound_that_is_not_met_THEN_it_is_named) {
  const std::pair<Row, const char*> cases[] = {{{"11 of 12", "5.9, 7.1", "3.90"}, "not every run aligned"},
                                               {{"9 of 9", "5.9, 7.1", "3.90"}, "too few runs"},
                                               {{"12 of 12", "5.9, 15.1", "3.90"}, "aligned too late"},
                                               {{"0 of 12", "–, –", "–"}, "aligned too late"},
                                               {{"12 of 12", "5.9, 7.1", "4.55"}, "NEES outside"},
                                               {{"12 of 12", "5.9, 7.1", "1.77"}, "NEES outside"},
                                               {{"12 of 12", "5.9, 7.1", "–"}, "NEES outside"}};
  for (const auto& [row, verdict] : cases) {
    const CommandResult result = Check(row);
    EXPECT_EQ(result.code, 1) << result.output;
    EXPECT_THAT(result.output, HasSubstr(verdict));
  }
}

TEST_F(FixAcceptanceTest, GIVEN_a_row_that_is_missing_THEN_it_fails) {
  const CommandResult result = Check({}, 2);
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.output, HasSubstr("found 3 of the 4"));
}

TEST_F(FixAcceptanceTest, GIVEN_runs_that_failed_THEN_the_others_are_checked_and_it_fails) {
  const CommandResult result = Check({}, 3, 7);
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.output, HasSubstr("some runs failed"));
  EXPECT_THAT(result.output, HasSubstr(": met"));
}

TEST_F(FixAcceptanceTest, GIVEN_a_comparison_that_ends_early_THEN_nothing_is_checked) {
  const CommandResult result = Check({}, 3, 6);
  EXPECT_EQ(result.code, 6);
  EXPECT_THAT(result.output, HasSubstr("compare ended with exit code 6"));
  EXPECT_THAT(result.output, testing::Not(HasSubstr(": met")));
}

}  // namespace
}  // namespace alidade
