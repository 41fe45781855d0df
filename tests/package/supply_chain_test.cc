#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/package/installed_tree.h"

// What the program is made of, and how it is linked.

namespace alidade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kProgram = std::string(ALIDADE_BINARY_DIR) + "/alidade";

TEST(SupplyChain, TheBillOfMaterialsNamesWhatIsLinkedWithVersionAndLicence) {
  const std::string command =
      std::string(ALIDADE_SOURCE_DIR) + "/scripts/packaging/sbom.sh '" + kProgram + "'";
  const CommandResult bill = Shell("SOURCE_DATE_EPOCH=1700000000 " + command);
  if (bill.code == 77) {
    GTEST_SKIP() << bill.output;
  }
  ASSERT_EQ(bill.code, 0) << bill.output;
  EXPECT_THAT(bill.output, AllOf(HasSubstr("\"spdxVersion\": \"SPDX-2.3\""),
                                 HasSubstr("\"created\": \"2023-11-14T22:13:20Z\""),
                                 HasSubstr("\"licenseDeclared\": \"GPL-2.0-or-later\"")));
  for (const char* linked : {"libyaml-cpp0.7", "libcholmod3", "libc6", "libopenblas0-pthread"}) {
    EXPECT_THAT(bill.output,
                HasSubstr("\"relationshipType\": \"DEPENDS_ON\", \"relatedSpdxElement\": \"SPDXRef-" +
                          std::string(linked) + "\""));
  }
  EXPECT_THAT(bill.output, HasSubstr("\"relationshipType\": \"CONTAINS\", \"relatedSpdxElement\": "
                                     "\"SPDXRef-libeigen3-dev\""));
  EXPECT_EQ(Shell(command + "-no-such").code, 2);
}

TEST(SupplyChain, TheProgramIsPositionIndependentAndItsTablesAreReadOnly) {
  if (Shell("command -v readelf").code != 0) {
    GTEST_SKIP() << "readelf is not installed (Debian package binutils)";
  }
  EXPECT_THAT(Shell("readelf -hW '" + kProgram + "'").output,
              HasSubstr("DYN (Position-Independent Executable"));
  const std::string segments = Shell("readelf -lW '" + kProgram + "' | grep -E 'GNU_RELRO|GNU_STACK'").output;
  EXPECT_THAT(segments, AllOf(HasSubstr("GNU_RELRO"), HasSubstr(" RW ")));  // a stack that is not executable
  EXPECT_THAT(Shell("readelf -dW '" + kProgram + "'").output, HasSubstr("BIND_NOW"));
}

}  // namespace
}  // namespace alidade::test
