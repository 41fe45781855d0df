#include "eval/files/machine.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

constexpr char kTwoCores[] =
    "processor\t: 0\nvendor_id\t: GenuineIntel\nmodel\t\t: 85\nmodel name\t: Intel(R) Xeon(R) CPU @ 2.80GHz\n"
    "cpu cores\t: 1\n\n"
    "processor\t: 1\nmodel name\t: Intel(R) Xeon(R) CPU @ 2.80GHz\nflags\t\t: fpu vme\n\n";

TEST(Machine, GivenCpuInfoThenModelAndLogicalCoresAreFound) {
  const Machine machine = ParseCpuInfo(kTwoCores);
  EXPECT_EQ(machine.cpu, "Intel(R) Xeon(R) CPU @ 2.80GHz");
  EXPECT_EQ(machine.cores, 2);
  EXPECT_EQ(ToString(machine), "Intel(R) Xeon(R) CPU @ 2.80GHz (2 logical cores)");
}

TEST(Machine, GivenAProcessorWithoutAModelNameThenOnlyItsCoresAreKnown) {
  const Machine machine = ParseCpuInfo("processor : 0\nBogoMIPS : 50.00\nCPU part : 0xd0c\nmodel name :");
  EXPECT_EQ(ToString(machine), "unknown (1 logical core)");
}

TEST(Machine, GivenNoFileThenItIsUnknown) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(ToString(ReadMachine(folder.File("none"))), "unknown");
  EXPECT_EQ(ReadMachine(folder.Write("cpuinfo", kTwoCores)).cores, 2);
  EXPECT_GE(ReadMachine().cores, 1);
}

}  // namespace
}  // namespace alidade
