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

TEST(SupplyChain, TheProgramIsLinkedHardenedAndInAPackageCompiledSo) {
  // The compiler's share shows in our archives: the program contains Debian's Ceres, which has it anyway.
  const std::string archives = ALIDADE_DISTRIBUTED ? " $(find '" + std::string(ALIDADE_BINARY_DIR) +
                                                         "' -name 'libalidade_*.a' -not -path '*/_CPack*')"
                                                   : "";
  const CommandResult hardening = Shell("'" + std::string(ALIDADE_SOURCE_DIR) +
                                        "/scripts/packaging/hardening.sh' '" + kProgram + "'" + archives);
  if (hardening.code == 77) {
    GTEST_SKIP() << hardening.output;
  }
  EXPECT_EQ(hardening.code, 0) << hardening.output;
  EXPECT_THAT(hardening.output,
              AllOf(HasSubstr("position-independent: yes"), HasSubstr("stack not executable: yes"),
                    HasSubstr("relocations read-only: yes"), HasSubstr("bound at start: yes")));
}

}  // namespace
}  // namespace alidade::test
