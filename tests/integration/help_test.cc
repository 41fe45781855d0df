#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/command.h"

namespace alidade {
namespace {

using test::Alidade;
using test::CommandResult;
using testing::HasSubstr;
using testing::Not;

TEST(Help, OfHelpIsTheGeneralText) {
  const CommandResult general = Alidade("help");
  EXPECT_EQ(general.code, 0);
  EXPECT_THAT(general.output, HasSubstr("Usage: alidade <command>"));
  const CommandResult of_help = Alidade("help help");
  EXPECT_EQ(of_help.code, 0);
  EXPECT_EQ(of_help.output, general.output);
}

TEST(Help, FitsOnAScreen) {
  EXPECT_LT(Alidade("help").output.size(), 2000u);
}

// GIVEN a flag of two meanings THEN the help of each command has its own.
TEST(Help, DescribesTheInputOfEachCommand) {
  const std::string cases = "JSON file of cases", folder = "output folder of compare";
  const std::string probe = Alidade("probe --help").output;
  EXPECT_THAT(probe, HasSubstr(cases));
  EXPECT_THAT(probe, Not(HasSubstr(folder)));
  const std::string study = Alidade("fault_study --help").output;
  EXPECT_THAT(study, HasSubstr(folder));
  EXPECT_THAT(study, Not(HasSubstr(cases)));
}

TEST(Help, PrintsDefaultsWithTheFewestDigits) {
  const std::string output = Alidade("evaluate --help").output;
  EXPECT_THAT(output, HasSubstr("relative tolerance of the delta (double, default 0.1)"));
  EXPECT_THAT(output, HasSubstr("(double, default 0.01)"));
}

TEST(Help, WritesFlagsWithUnderscoresAndTheProgramTakesDashesToo) {
  const std::string output = Alidade("evaluate --help").output;
  EXPECT_THAT(output, HasSubstr("--rpe_by "));
  EXPECT_THAT(output, Not(HasSubstr("--rpe-by")));
  for (const char* flag : {"--max_dt", "--max-dt"}) {
    const CommandResult result =
        Alidade("evaluate --truth=truth.csv --estimate=estimate.csv " + std::string(flag) + "=x");
    EXPECT_EQ(result.code, 2) << flag;
    EXPECT_THAT(result.output, HasSubstr("evaluate: --max_dt: found 'x'")) << flag;
  }
}

}  // namespace
}  // namespace alidade
