#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/integration/command.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::CommandResult;
using test::Shell;
using test::Source;
using testing::HasSubstr;
using testing::IsEmpty;

class LayersTest : public testing::Test {
 protected:
  LayersTest() { tree_.Write("scripts/layers.txt", test::ReadFile(Source("scripts/layers.txt"))); }

  CommandResult Check() const { return Shell(Source("scripts/check_layers.sh") + " " + tree_.path()); }

  test::TemporaryFolder tree_;
};

TEST(Layers, GivenTheSourcesThenNoIncludeRunsAgainstTheirOrder) {
  const CommandResult result = Shell(Source("scripts/check_layers.sh"));
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.output, IsEmpty());
}

TEST_F(LayersTest, GivenAnIncludeOfALaterRoomThenItIsNamed) {
  tree_.Write("core/lie.h", "#pragma once\n#include \"core/time.h\"\n");
  tree_.Write("eval/files/csv.h", "#include \"core/lie.h\"\n#include \"eval/report/report_data.h\"\n");
  const CommandResult result = Check();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.output, HasSubstr("eval/files/csv.h:2: eval/files includes eval/report/report_data.h"));
}

TEST_F(LayersTest, GivenOneBackEndThatIncludesTheOtherThenItIsNamed) {
  tree_.Write("smoother/batch/batch_solver.cc", "#include \"filter/filter.h\"\n");
  EXPECT_THAT(Check().output, HasSubstr("smoother/batch must not include filter/filter.h"));
}

TEST_F(LayersTest, GivenAPackageWhereItMustNotBeThenItIsNamed) {
  tree_.Write("filter/filter.cc", "#include <ceres/problem.h>\n");
  tree_.Write("smoother/window/window.cc", "#include <ceres/problem.h>\n");
  const CommandResult result = Check();
  EXPECT_THAT(result.output, HasSubstr("filter must not include <ceres/problem.h>: only"));
  EXPECT_THAT(result.output, testing::Not(HasSubstr("smoother/window")));
}

TEST_F(LayersTest, GivenAPackageOfOtherRoomsThenTheRoomIsNamed) {
  tree_.Write("eval/run/session.cc",
              "#include <bzlib.h>\n#include <lz4frame.h>\n#include <nlohmann/json.hpp>\n");
  tree_.Write("eval/rosbag/rosbag_chunk.cc", "#include <bzlib.h>\n#include <lz4frame.h>\n");
  tree_.Write("eval/report/report_json.cc", "#include <nlohmann/json.hpp>\n");
  const CommandResult result = Check();
  for (const char* header : {"bzlib.h", "lz4frame.h", "nlohmann/json.hpp"}) {
    EXPECT_THAT(result.output, HasSubstr("eval/run must not include <" + std::string(header) + ">: only"));
  }
  EXPECT_THAT(result.output, testing::Not(HasSubstr("eval/rosbag must not")));
  EXPECT_THAT(result.output, testing::Not(HasSubstr("eval/report must not")));
}

TEST_F(LayersTest, GivenUnitsOfARoomThatIncludeEachOtherThenTheCircleIsNamed) {
  tree_.Write("core/lie.h", "#pragma once\n#include \"core/time.h\"\n");
  tree_.Write("core/time.cc", "#include \"core/time.h\"\n\n#include \"core/lie.h\"\n");
  const CommandResult result = Check();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.output,
              HasSubstr("circle of units: core/lie -> core/time (core/lie.h) -> core/lie (core/time.cc)"));
}

TEST_F(LayersTest, GivenASourceWithoutAHeaderOfItsNameThenItBelongsToTheFirstHeaderOfTheRoom) {
  tree_.Write("core/camera_lens.cc",
              "#include \"core/camera.h\"\n#include \"core/format.h\"\n#include \"core/lens.h\"\n");
  tree_.Write("core/lens.h", "#pragma once\n#include \"core/camera.h\"\n");
  tree_.Write("core/format.cc", "#include \"core/format.h\"\n\n#include \"core/time.h\"\n");
  EXPECT_THAT(
      Check().output,
      testing::Eq(
          "circle of units: core/camera -> core/lens (core/camera_lens.cc) -> core/camera (core/lens.h)\n"));
}

TEST_F(LayersTest, GivenAFolderThatIsNotListedThenItIsNamed) {
  tree_.Write("eval/attic/old.h", "#include <vector>\n");
  const CommandResult result = Check();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.output, HasSubstr("eval/attic/old.h:1: its folder is not in scripts/layers.txt"));
}

}  // namespace
}  // namespace alidade
