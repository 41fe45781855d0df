#include "eval/bag/dataset_source.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

// Which format a path names.

namespace alidade {
namespace {

struct FormatCase {
  const char* name;
  const char* path;
  bool is_asl;
  bool is_there;
};

class FormatOfTest : public testing::TestWithParam<FormatCase> {};

TEST_P(FormatOfTest, GivenAPathThenItsFormatAndWhetherItExists) {
  const test::TemporaryFolder folder;
  folder.Write("folder.bag/mav0/x", "");
  folder.Write("file.bag", "");
  folder.Write("file.txt", "");
  const std::string path = folder.File(GetParam().path);
  EXPECT_EQ(FormatOf(path).is_asl, GetParam().is_asl);
  EXPECT_EQ(FormatOf(path).is_file(), !GetParam().is_asl);
  EXPECT_EQ(FormatOf(path).takes_topics, !GetParam().is_asl);
  EXPECT_EQ(IsDataset(path), GetParam().is_there);
}

INSTANTIATE_TEST_SUITE_P(Paths, FormatOfTest,
                         testing::Values(FormatCase{"AFolderNamedAsABag", "folder.bag", true, true},
                                         FormatCase{"ABag", "file.bag", false, true},
                                         FormatCase{"AMissingBag", "none.bag", false, false},
                                         FormatCase{"AMissingFolder", "none", true, false},
                                         FormatCase{"AnotherFile", "file.txt", true, false}),
                         [](const auto& test_case) { return std::string(test_case.param.name); });

// A missing bag is reported as a file, whichever flags are with it.
TEST(MissingDataset, IsReportedInItsFormat) {
  const test::TemporaryFolder folder;
  const Result<Dataset> bag = ReadDataset({folder.File("none.bag"), "imu=/imu", {}});
  EXPECT_EQ(bag.code(), StatusCode::kInput) << bag.message();
  EXPECT_EQ(ReadDataset({folder.File("none"), "imu=/imu", {}}).code(), StatusCode::kUsage);
}

}  // namespace
}  // namespace alidade
