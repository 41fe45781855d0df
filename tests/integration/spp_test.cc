#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/integration/command.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::Alidade;
using test::CommandResult;
using testing::HasSubstr;

TEST(SppCommand, WritesRtklibsFormatAndEqualBytesEachTime) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string data = test::SharedDir() + "/data/gnss/rinex4_kms3/";
  const test::TemporaryFolder folder;
  const std::string call = "spp --obs=" + data + "KMS300DNK_R_20221591000_01H_30S_MO.crx --nav=" + data +
                           "KMS300DNK_R_20221591000_01H_MN.rnx --output=";
  const CommandResult first = Alidade(call + folder.File("a.pos"));
  EXPECT_EQ(first.code, 0) << first.output;
  EXPECT_THAT(first.output, HasSubstr("19 of 19 epochs solved"));
  ASSERT_EQ(Alidade(call + folder.File("b.pos") + " --quiet").output, "");
  const std::string text = test::ReadFile(folder.File("a.pos"));
  EXPECT_EQ(text, test::ReadFile(folder.File("b.pos")));
  EXPECT_THAT(text, HasSubstr("% inp file  : KMS300DNK_R_20221591000_01H_MN.rnx\n"));
  EXPECT_THAT(text, HasSubstr("\n2022/06/08 10:00:00.000   55."));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n') - 19, 5) << "header lines";
  EXPECT_EQ(Alidade(call + folder.File("a.pos")).code, 6);
  EXPECT_EQ(Alidade(call + folder.File("a.pos") + " --overwrite --set=systems=G").code, 0);
  EXPECT_NE(text, test::ReadFile(folder.File("a.pos")));
}

TEST(SppCommand, ReportsWhyNoEpochIsSolved) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string data = test::SharedDir() + "/data/gnss/";
  const test::TemporaryFolder folder;
  const CommandResult result = Alidade("spp --obs=" + data + "rinex4_kms3/KMS3.rnx --nav=" + data +
                                       "precise_cod/brdc1180.21n --output=" + folder.File("a.pos"));
  EXPECT_EQ(result.code, 4);
  EXPECT_THAT(result.output, HasSubstr("no epoch has a solution"));
  EXPECT_THAT(result.output, HasSubstr("without ephemeris"));
}

}  // namespace
}  // namespace alidade
