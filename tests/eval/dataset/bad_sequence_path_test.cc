// Paths of a sequence that lead to no folder or no file: a Status that names them, at once.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <string>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_reader.h"
#include "tests/support/good_sequence.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::WriteGoodSequence;
using testing::HasSubstr;

class NotAFile : public testing::TestWithParam<const char*> {};

TEST_P(NotAFile, IsRefusedAtOnceWithItsName) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  const std::string name = std::string("mav0/") + GetParam();
  const std::string path = folder.File(name);
  std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const Result<Dataset> pipe = ReadDataset(folder.path());
  EXPECT_EQ(pipe.code(), StatusCode::kInput);
  EXPECT_THAT(pipe.message(), HasSubstr(name + ": is a pipe, expected a file"));

  std::filesystem::remove(path);
  std::filesystem::create_symlink("/dev/zero", path);
  const Result<Dataset> device = ReadDataset(folder.path());
  EXPECT_EQ(device.code(), StatusCode::kInput);
  EXPECT_THAT(device.message(), HasSubstr(name + ": is a device, expected a file"));

  std::filesystem::remove(path);
  std::filesystem::create_symlink(path, path);
  const Result<Dataset> loop = ReadDataset(folder.path());
  EXPECT_EQ(loop.code(), StatusCode::kInput);
  EXPECT_THAT(loop.message(), HasSubstr(name + ": cannot be read: Too many levels of symbolic links"));

  std::filesystem::remove(path);
  folder.Write(name, "");
  std::filesystem::resize_file(path, std::uintmax_t{1} << 33);
  const Result<Dataset> sparse = ReadDataset(folder.path());
  EXPECT_EQ(sparse.code(), StatusCode::kInput);
  EXPECT_THAT(sparse.message(), HasSubstr(name + ": is larger than expected"));
}

INSTANTIATE_TEST_SUITE_P(Path, NotAFile,
                         testing::Values("imu0/sensor.yaml", "imu0/data.csv", "cam0/sensor.yaml",
                                         "cam0/tracks.csv", "cam0/data.csv", "cam0/timestamps.csv",
                                         "state_groundtruth_estimate0/data_pose.csv"));

TEST(BadSequenceFolder, GivenALongNameOrALoopOfLinksThenTheReasonIsTold) {
  const test::TemporaryFolder folder;
  const Result<Dataset> longer = ReadDataset(folder.File(std::string(300, 'x')));
  EXPECT_EQ(longer.code(), StatusCode::kInput);
  EXPECT_THAT(longer.message(), HasSubstr("File name too long"));
  std::filesystem::create_directory_symlink(folder.File("loop"), folder.File("loop"));
  const Result<Dataset> loop = ReadDataset(folder.File("loop"));
  EXPECT_EQ(loop.code(), StatusCode::kInput);
  EXPECT_THAT(loop.message(), HasSubstr("Too many levels of symbolic links"));
}

TEST(BadSequenceFolder, GivenNoFolderOrMav0ItselfThenTheMessageSaysWhatToGive) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  const Result<Dataset> inside = ReadDataset(folder.File("mav0"));
  EXPECT_EQ(inside.code(), StatusCode::kInput);
  EXPECT_THAT(inside.message(), HasSubstr("give the folder that contains it"));
  const Result<Dataset> missing = ReadDataset(folder.File("nowhere"));
  EXPECT_EQ(missing.code(), StatusCode::kInput);
  EXPECT_THAT(missing.message(), HasSubstr("nowhere: no such folder"));
}

}  // namespace
}  // namespace alidade
