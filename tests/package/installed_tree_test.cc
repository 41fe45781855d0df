#include "tests/package/installed_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

const std::string kProgram = Installed("bin/alidade");

TEST(InstalledTree, ShippedConfigurationsAreFoundFromAnyFolder) {
  TemporaryFolder folder;
  const CommandResult run = ShellIn(folder.path(), SimulateAndRun(kProgram));
  EXPECT_EQ(run.code, 0) << run.output;
  EXPECT_THAT(ReadFile(folder.File("out/run.json")), HasSubstr("\"alidade_filter\""));
  // By name, by name with suffix and by the path that the pages print.
  for (const char* config : {"gvio", "gvio.yaml", "configs/estimators/gvio.yaml"}) {
    const CommandResult check = ShellIn(folder.path(), kProgram + " config --check " + std::string(config));
    EXPECT_EQ(check.output, Installed("share/alidade/configs/estimators/gvio.yaml: no faults\n"));
  }
}

TEST(InstalledTree, EveryShippedNameIsAFileWithoutFaults) {
  TemporaryFolder folder;
  for (const std::string kind : {"estimator", "simulator"}) {
    const CommandResult list = Shell(kProgram + " config --list --kind=" + kind);
    EXPECT_EQ(list.code, 0) << list.output;
    EXPECT_THAT(list.output, HasSubstr(kind == "estimator" ? "alidade_smoother\n" : "figure8_short\n"));
  }
  const CommandResult plans = Shell(kProgram + " config --list --kind=plan");
  EXPECT_THAT(plans.output, HasSubstr("demo\n"));
  const CommandResult demo = ShellIn(folder.path(), kProgram + " config --check --kind=plan demo");
  EXPECT_EQ(demo.code, 0) << demo.output;
}

TEST(InstalledTree, AFileOfTheUserComesBeforeAShippedOne) {
  TemporaryFolder folder;
  folder.Write("gvio.yaml", "no_such_key: 1\n");
  const CommandResult check = ShellIn(folder.path(), kProgram + " config --check gvio.yaml");
  EXPECT_EQ(check.code, 3);
  EXPECT_THAT(check.output, HasSubstr("gvio.yaml:1:1"));
}

TEST(InstalledTree, TheEnvironmentNamesOtherConfigurations) {
  TemporaryFolder folder;
  folder.Write("configs/base.yaml", "name: mine\n");
  folder.Write("configs/estimators/own.yaml", "name: own\n");
  const std::string data = "ALIDADE_DATA_DIR='" + folder.path() + "' ";
  EXPECT_EQ(Shell(data + kProgram + " config --list").output, "own\n");
  EXPECT_EQ(Shell(data + kProgram + " config --check own").code, 0);

  const CommandResult unknown = Shell(data + kProgram + " config --check owm");
  EXPECT_EQ(unknown.code, 3);
  EXPECT_THAT(unknown.output, HasSubstr("did you mean 'own'?"));

  const CommandResult nowhere = Shell("ALIDADE_DATA_DIR=/no/such/folder " + kProgram + " config --list");
  EXPECT_EQ(nowhere.code, 3);
  EXPECT_THAT(nowhere.output, HasSubstr("/no/such/folder"));
}

TEST(InstalledTree, WhatIsInstalledDoesNotKnowWhereItWasBuilt) {
  const CommandResult found = Shell("grep -rlF '" + Source("") + "' " + Installed("share ") +
                                    Installed(std::string(ALIDADE_LIBDIR) + "/cmake"));
  EXPECT_EQ(found.code, 1) << found.output;
}

}  // namespace
}  // namespace alidade::test
