#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::Alidade;
using test::CommandResult;
using test::Source;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

// GIVEN 25 s without tracks from 10 to 12 s, and the same without the fault, THEN the blackout was reported
// within 0.3 s, the status is ok with the first tracks, the pose is covered all the time, and the position is
// soon as good as without the fault.
TEST(FaultStudyCommand, ABlackoutOfTwoSeconds) {
  const test::TemporaryFolder folder;
  const std::string scene = "  - {config: " + Source("configs/datasets/figure8.yaml") + ", seeds: 105, ";
  const std::string plan =
      folder.Write("plan.yaml", "set: {init.method: truth}\nestimators:\n  - " +
                                    Source("configs/estimators/alidade_filter.yaml") + "\nsequences:\n" +
                                    scene + "name: clean, set: {duration_s: 25, path_m: 32.5}}\n" + scene +
                                    "name: blackout, set: {duration_s: 25, path_m: 32.5, fault: blackout, "
                                    "fault_start_s: 10, fault_duration_s: 2}}\n");
  const std::string study = "fault_study --quiet --plan=" + plan + " --input=" + folder.File("out");
  const CommandResult early = Alidade(study);
  EXPECT_EQ(early.code, 4);
  EXPECT_THAT(early.output, HasSubstr("holds no run of the simulated sequences with a fault"));

  ASSERT_EQ(Alidade("compare --quiet --plan=" + plan + " --output=" + folder.File("out")).code, 0);
  const CommandResult result = Alidade(study);
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.output,
              ContainsRegex("\\| blackout \\| `alidade_filter` \\| 1 \\| 0\\.[0-3]0, 0\\.[0-3]0 \\| "
                            "0\\.[0-3]0, 0\\.[0-3]0 \\| 0\\.00, 0\\.00 \\| [0-9]\\.[0-9]0, [0-9]\\.[0-9]0 "
                            "\\| 0\\.00, 0\\.00 \\|"));
  EXPECT_THAT(result.output, Not(HasSubstr("| clean |"))) << "has no fault";
  EXPECT_THAT(result.output, Not(HasSubstr("\\*"))) << "the clean run was found";

  std::string more = test::ReadFile(plan);
  more.insert(more.find(scene), scene + "name: not_run, set: {duration_s: 25, path_m: 32.5}}\n");
  EXPECT_EQ(Alidade("fault_study --quiet --plan=" + folder.Write("more.yaml", more) +
                    " --input=" + folder.File("out"))
                .output,
            result.output)
      << "another sequence without the fault comes first, without a run";
}

}  // namespace
}  // namespace alidade
