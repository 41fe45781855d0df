// The browser's second attempts, with scripts in its place.
#include "tests/eval/report/headless_browser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using ::testing::HasSubstr;

class HeadlessBrowserTest : public ::testing::Test {
 protected:
  /// A program that notes each run and its profile in `runs`, then does `body`; $n is the number of the run.
  std::string Program(const std::string& body) {
    const std::string runs = folder_.File("runs");
    std::string program =
        folder_.Write("browser", "#!/bin/sh\nfor word; do case $word in --user-data-dir=*) echo $word >>" +
                                     runs + ";; esac; done\nn=$(wc -l <" + runs + ")\n" + body + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return program;
  }
  /// The profiles of the runs so far.
  [[nodiscard]] std::vector<std::string> Profiles() const {
    std::istringstream lines(ReadFile(folder_.File("runs")));
    std::vector<std::string> profiles;
    for (std::string line; std::getline(lines, line);) {
      profiles.push_back(line);
    }
    return profiles;
  }

  TemporaryFolder folder_;
};

TEST_F(HeadlessBrowserTest, GivenABrowserThatHangsOnceThenASecondAttemptInAFreshProfileCounts) {
  const HeadlessBrowser browser(Program("[ $n = 1 ] && sleep 60\necho '<html data-ready=\"true\"><head>'"),
                                3);
  const Result<PageVisit> visit = browser.Open("/page.html");
  ASSERT_TRUE(visit.ok()) << visit.message();
  EXPECT_EQ(visit->Mark("ready"), "true");
  ASSERT_EQ(Profiles().size(), 2U);
  EXPECT_NE(Profiles()[0], Profiles()[1]);
}

TEST_F(HeadlessBrowserTest, GivenABrowserThatCrashesOnceThenTheFirstOutputIsForgotten) {
  const HeadlessBrowser browser(
      Program("echo run $n; echo CONSOLE $n >&2; [ $n = 1 ] && kill -SEGV $$; exit 0"));
  const Result<PageVisit> visit = browser.Open("/page.html");
  ASSERT_TRUE(visit.ok()) << visit.message();
  EXPECT_EQ(visit->dom, "run 2\n");
  EXPECT_EQ(visit->console, "CONSOLE 2\n");
}

TEST_F(HeadlessBrowserTest, GivenABrowserThatAlwaysHangsThenThereIsNoVisit) {
  const HeadlessBrowser browser(Program("echo '<html data-ready=\"true\">'; echo stuck >&2; sleep 60"), 2);
  const Result<PageVisit> visit = browser.Open("/page.html");
  ASSERT_FALSE(visit.ok());
  EXPECT_THAT(visit.message(), HasSubstr("attempt 3 of 3: hung for 2 s; it wrote:\nstuck"));
  EXPECT_EQ(Profiles().size(), 3U);
}

TEST_F(HeadlessBrowserTest, GivenAPageThatComplainsThenItIsNotAskedAgain) {
  const HeadlessBrowser browser(
      Program("echo '<html data-errors=\"torn\"><head>'; echo 'CONSOLE: torn' >&2"));
  const Result<PageVisit> visit = browser.Open("/page.html");
  ASSERT_TRUE(visit.ok()) << visit.message();
  EXPECT_EQ(visit->Mark("errors"), "torn");
  EXPECT_EQ(visit->console, "CONSOLE: torn\n");
  EXPECT_EQ(Profiles().size(), 1U);
}

}  // namespace
}  // namespace alidade::test
