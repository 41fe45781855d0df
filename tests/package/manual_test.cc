#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/package/installed_tree.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

const std::string kPage = Installed("share/man/man1/alidade.1");

TEST(Manual, TheInstalledPageIsThatOfTheProgram) {
  EXPECT_EQ(ReadFile(kPage), Alidade("manual").output);
  EXPECT_THAT(ReadFile(kPage), HasSubstr("alidade " ALIDADE_VERSION));
}

TEST(Manual, ShowsEveryCommandFlagAndExitCodeWithoutWarnings) {
  if (Shell("command -v man groff").code != 0) {
    GTEST_SKIP() << "man is not installed (Debian packages man-db and groff-base)";
  }
  // In braces, so that errors are not thrown away with the page.
  const CommandResult warnings =
      Shell("{ LC_ALL=C.UTF-8 MANROFFSEQ= man --warnings -E UTF-8 -l -Tutf8 -Z " + kPage + " >/dev/null; }");
  EXPECT_EQ(warnings.output, "");

  const CommandResult page = Shell("LC_ALL=C.UTF-8 MANWIDTH=500 man -l -Tascii " + kPage + " | col -bx");
  for (const char* text :
       {"alidade simulate", "alidade gnss_study", "alidade fault_study", "--anchor_at_first",
        "--backend=WORD", "posyaw | se3", "Default: 0.01.", "some cells of a comparison failed",
        "ALIDADE_DATA_DIR", "alidade compare --plan=demo"}) {
    EXPECT_THAT(page.output, HasSubstr(text));
  }
}

}  // namespace
}  // namespace alidade::test
