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

TEST(BadSequenceFolder, GivenALongNameOrALoopOfLinksThenTheReasonIsReported) {
  const test::TemporaryFolder folder;
  const Result<Dataset> longer = ReadDataset(folder.File(std::string(300, 'x')));
  EXPECT_EQ(longer.code(), StatusCode::kInput);
  EXPECT_THAT(longer.message(), HasSubstr("File name too long"));
  std::filesystem::create_directory_symlink(folder.File("loop"), folder.File("loop"));
  const Result<Dataset> loop = ReadDataset(folder.File("loop"));
  EXPECT_EQ(loop.code(), StatusCode::kInput);
  EXPECT_THAT(loop.message(), HasSubstr("Too many levels of symbolic links"));
}

TEST(BadSequenceFolder, GivenNoFolderOrMav0ItselfThenTheMessageNamesWhatToGive) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  const Result<Dataset> inside = ReadDataset(folder.File("mav0"));
  EXPECT_EQ(inside.code(), StatusCode::kInput);
  EXPECT_THAT(inside.message(), HasSubstr("give the folder that contains it"));
  const Result<Dataset> missing = ReadDataset(folder.File("nowhere"));
  EXPECT_EQ(missing.code(), StatusCode::kInput);
  EXPECT_THAT(missing.message(), HasSubstr("nowhere: no such folder"));
}

/// A sequence that lists an image twice, which is missing, in the folder `name`.
void WriteSequenceWithAnImage(const test::TemporaryFolder& folder, const std::string& name) {
  folder.Write(name + "/mav0/imu0/sensor.yaml", test::kImuYaml);
  folder.Write(name + "/mav0/imu0/data.csv", std::string(test::kImuHeader) + test::kImuRows);
  folder.Write(name + "/mav0/cam0/sensor.yaml", test::CameraYaml(test::kIdentity, test::kNoLens));
  folder.Write(name + "/mav0/cam0/data.csv", "#timestamp [ns],filename\n1000,1.png\n2000,1.png\n");
  std::filesystem::create_directory(folder.File(name + "/mav0/cam0/data"));
}

// GIVEN an image that is a link to a file elsewhere WHEN the sequence is read THEN it is refused with the
// place the link leads to.
TEST(BadSequenceLink, GivenAnImageThatIsALinkOutOfTheSequenceThenItIsRefused) {
  const test::TemporaryFolder folder;
  WriteSequenceWithAnImage(folder, "seq");
  const std::string secret = folder.Write("secret.png", "not for a sequence");
  std::filesystem::create_symlink(secret, folder.File("seq/mav0/cam0/data/1.png"));
  const Result<Dataset> dataset = ReadDataset(folder.File("seq"));
  EXPECT_EQ(dataset.code(), StatusCode::kInput);
  EXPECT_THAT(dataset.message(),
              HasSubstr("data.csv:2: column 2 (filename): found '1.png', expected a file of "
                        "this sequence, not a link to "));
  EXPECT_THAT(dataset.message(), HasSubstr("secret.png outside of it"));
  EXPECT_THAT(dataset.message(), HasSubstr("--follow_links"));
  const Result<Dataset> followed = ReadDataset(folder.File("seq"), {.follow_links = true});
  ASSERT_TRUE(followed.ok()) << followed.message();
  EXPECT_EQ(followed->images.size(), 2u);
}

// GIVEN a folder beside the sequence whose name begins with the sequence's WHEN an image leads there THEN it
// is refused: names are compared whole; WHEN images of several subfolders are links THEN each is checked by
// its own folder.
TEST(BadSequenceLink, GivenALinkToANeighbourThenItIsRefused) {
  namespace fs = std::filesystem;
  const test::TemporaryFolder folder;
  WriteSequenceWithAnImage(folder, "seq");
  folder.Write("disk/1.png", "x");
  folder.Write("sequel/1.png", "x");
  fs::create_directory_symlink(folder.File("disk"), folder.File("seq/mav0/cam0/data/a"));
  fs::create_directory(folder.File("seq/mav0/cam0/data/b"));
  fs::create_symlink("1.png", folder.File("disk/2.png"));
  folder.Write("seq/mav0/cam0/data.csv", "#timestamp [ns],filename\n1000,a/2.png\n2000,b/1.png\n");
  const auto message = [&folder](const std::string& target) {
    const std::string link = folder.File("seq/mav0/cam0/data/b/1.png");
    fs::remove(link);
    fs::create_symlink(folder.File(target), link);
    return ReadDataset(folder.File("seq")).message();
  };
  EXPECT_THAT(message("sequel/1.png"), HasSubstr("data.csv:3: column 2 (filename): found 'b/1.png'"));
  EXPECT_THAT(message("disk/1.png"), HasSubstr("data.csv:3: column 2 (filename): found 'b/1.png'"));
}

// GIVEN links that users make (of folders, within the sequence, of every file of another sequence) THEN the
// images are read.
TEST(BadSequenceLink, GivenLinkedFoldersAndLinksWithinThenTheyAreFollowed) {
  namespace fs = std::filesystem;
  const test::TemporaryFolder folder;
  const auto images = [&folder](const std::string& name) {
    const Result<Dataset> dataset = ReadDataset(folder.File(name));
    EXPECT_TRUE(dataset.ok()) << name << ": " << dataset.message();
    return dataset.ok() ? dataset->images.size() : 0;
  };
  WriteSequenceWithAnImage(folder, "seq");
  folder.Write("seq/raw/1.png", "x");
  fs::create_symlink("../../../raw/1.png", folder.File("seq/mav0/cam0/data/1.png"));
  EXPECT_EQ(images("seq"), 2u);
  fs::create_directory_symlink(folder.File("seq"), folder.File("link"));
  EXPECT_EQ(images("link"), 2u);

  WriteSequenceWithAnImage(folder, "linked");
  fs::remove(folder.File("linked/mav0/cam0/data"));
  folder.Write("disk/2.png", "x");
  fs::create_symlink("2.png", folder.File("disk/1.png"));
  fs::create_directory_symlink(folder.File("disk"), folder.File("linked/mav0/cam0/data"));
  EXPECT_EQ(images("linked"), 2u);

  WriteSequenceWithAnImage(folder, "real");
  folder.Write("real/mav0/cam0/data/1.png", "x");
  WriteSequenceWithAnImage(folder, "farm");
  fs::remove(folder.File("farm/mav0/cam0/data.csv"));
  for (const char* file : {"mav0/cam0/data.csv", "mav0/cam0/data/1.png"}) {
    fs::create_symlink(folder.File(std::string("real/") + file), folder.File(std::string("farm/") + file));
  }
  EXPECT_EQ(images("farm"), 2u);
}

}  // namespace
}  // namespace alidade
