#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

CommandResult Peers(const std::string& words) {
  return Shell(Source("scripts/peers.sh") + " " + words);
}

TEST(PeersScript, GivenACheckoutOfAnotherCommitThenItNamesTheExpectedOne) {
  const TemporaryFolder folder;
  const std::string git = "git -C " + folder.path() + " -c user.name=a -c user.email=a ";
  ASSERT_EQ(Shell(git + "init -q && " + git + "commit -q --allow-empty -m a").code, 0);
  const CommandResult result =
      Peers("open_vins --source=" + folder.path() + " --build=" + folder.File("build"));
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.output, HasSubstr("was written for 69488123ed9362dd44b6f28e7f4680abbff1442b"));
  EXPECT_THAT(result.output, HasSubstr("checkout 69488123"));
  EXPECT_FALSE(std::filesystem::exists(folder.File("build")));
}

TEST(PeersScript, AFolderWithoutACommitIsRefused) {
  const TemporaryFolder folder;
  const CommandResult result = Peers("vins_mono --source=" + folder.path());
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.output, HasSubstr("is no git checkout"));
}

TEST(PeersScript, GvinsWantsACheckoutOfItsOwnAndOneOfGnssComm) {
  const TemporaryFolder folder;
  const std::string git = "git -C " + folder.path() + " -c user.name=a -c user.email=a ";
  ASSERT_EQ(Shell(git + "init -q && " + git + "commit -q --allow-empty -m a").code, 0);
  const CommandResult other = Peers("gvins --source=" + folder.path() + " --build=" + folder.File("build"));
  EXPECT_EQ(other.code, 3);
  EXPECT_THAT(other.output, HasSubstr("was written for d2cf40b49c6eb0e6ad3caa4f613713983be3fd74 of gvins"));
  EXPECT_EQ(Peers("ingvio --gnss_comm=" + folder.path()).code, 2) << "it holds a copy of its own";
  EXPECT_EQ(Peers("gvins --lie_plusplus=" + folder.path()).code, 2) << "it is MSCEqF's";
}

TEST(PeersScript, HelpNamesTheLicence) {
  const CommandResult result = Peers("no_such_system");
  EXPECT_EQ(result.code, 2);
  for (const char* name :
       {"open_vins", "sqrt_vins", "vins_mono", "gvins", "gnss_comm", "ingvio", "msceqf", "Lie-plusplus"}) {
    EXPECT_THAT(result.output, HasSubstr(name));
  }
  EXPECT_THAT(result.output, HasSubstr("GPL-3"));
}

}  // namespace
}  // namespace alidade::test
