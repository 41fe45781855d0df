#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/package/installed_tree.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(DebianPackage, HoldsTheProgramAndWhatItNeedsAndRunsWhereverItIsUnpacked) {
  if (Shell("command -v dpkg-deb dpkg-shlibdeps file").code != 0) {
    GTEST_SKIP() << "the tools that make a package are not installed (Debian packages dpkg-dev and file)";
  }
  TemporaryFolder folder;
  const CommandResult packed = ShellIn(
      ALIDADE_BINARY_DIR, ALIDADE_CPACK " -G DEB -D CPACK_COMPONENTS_ALL=runtime -B '" + folder.path() + "'");
  ASSERT_EQ(packed.code, 0) << packed.output;
  const std::string package = folder.File("alidade_" ALIDADE_VERSION "_*.deb");

  const CommandResult control = Shell("dpkg-deb -I " + package);
  EXPECT_THAT(control.output, AllOf(HasSubstr(" Package: alidade\n"), HasSubstr(" Section: science\n"),
                                    HasSubstr(" Version: " ALIDADE_VERSION "\n"), HasSubstr("libc6 (>= "),
                                    HasSubstr("libopenblas0"), HasSubstr("libopencv-core"),
                                    HasSubstr("bench for GNSS-visual-inertial")));
  // Nothing that only the machine of the build has, and no compiler.
  const CommandResult depends = Shell("dpkg-deb -f " + package + " Depends");
  EXPECT_THAT(depends.output, AllOf(Not(HasSubstr("atlas")), Not(HasSubstr("-dev"))));

  const CommandResult content = Shell("dpkg-deb -c " + package);
  for (const char* path : {"./usr/bin/alidade\n", "./usr/share/alidade/configs/base.yaml\n",
                           "./usr/share/alidade/configs/plans/demo.yaml\n", "./usr/share/man/man1/alidade.1",
                           "./usr/share/bash-completion/completions/alidade\n",
                           "./usr/share/doc/alidade/README.md\n", "./usr/share/doc/alidade/LICENSE\n"}) {
    EXPECT_THAT(content.output, HasSubstr(path));
  }
  EXPECT_THAT(content.output, AllOf(Not(HasSubstr(".a\n")), Not(HasSubstr(".h\n"))));

  ASSERT_EQ(Shell("dpkg-deb -x " + package + " " + folder.File("root")).code, 0);
  const std::string program = folder.File("root/usr/bin/alidade");
  EXPECT_EQ(Shell(program + " --version").output, "alidade " ALIDADE_VERSION "\n");
  const CommandResult run = ShellIn(folder.path(), SimulateAndRun(program));
  EXPECT_EQ(run.code, 0) << run.output;
  EXPECT_THAT(ReadFile(folder.File("out/run.json")), HasSubstr("\"alidade_filter\""));
}

}  // namespace
}  // namespace alidade::test
