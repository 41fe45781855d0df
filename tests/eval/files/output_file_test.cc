#include "eval/files/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "eval/files/input_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

TEST(OutputFile, WhenWrittenThenFoldersAreMadeAndNoTemporaryStays) {
  const test::TemporaryFolder folder;
  const std::string path = folder.File("a/b/c.txt");
  ASSERT_TRUE(WriteFileAtomically(path, "first").ok());
  ASSERT_TRUE(WriteFileAtomically(path, "second").ok());
  EXPECT_EQ(ReadWholeFile(path).value(), "second");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.File("a/b"))) {
    files += entry.exists() ? 1 : 0;
  }
  EXPECT_EQ(files, 1);
}

TEST(OutputFile, GivenAPathThatCannotBeWrittenThenTheStatusNamesIt) {
  const test::TemporaryFolder folder;
  folder.Write("file", "");
  const Status below_a_file = WriteFileAtomically(folder.File("file/x"), "content");
  EXPECT_EQ(below_a_file.code(), StatusCode::kOutput);
  EXPECT_THAT(below_a_file.message(), testing::HasSubstr("file"));
  std::filesystem::create_directories(folder.File("folder/inner"));
  const Status over_a_folder = WriteFileAtomically(folder.File("folder"), "content");
  EXPECT_EQ(over_a_folder.code(), StatusCode::kOutput);
  EXPECT_THAT(over_a_folder.message(), testing::HasSubstr("cannot be replaced"));
}

TEST(ShortestDouble, ReadsBackToTheSameNumber) {
  for (const double value : {0.1, 1.0 / 3.0, -1e-300, 1403715273.262142976,
                             std::numeric_limits<double>::denorm_min(), std::nextafter(1.0, 2.0), 0.0}) {
    EXPECT_EQ(std::strtod(ShortestDouble(std::abs(value)).c_str(), nullptr), std::abs(value));
  }
  EXPECT_EQ(ShortestDouble(0.1), "0.1");
  EXPECT_EQ(ShortestDouble(20), "20");
}

TEST(RemoveTemporaryFiles, TakesWhatAKilledProcessLeftAndNothingElse) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a/states.csv.tmp999999999_345", "b.tmp99999999999999999999_2", "a/states.csv",
                           "c.tmp", "d.tmp12_x", "e.tmp1_2.csv", "of_the_process_that_runs_all.tmp1_2"}) {
    folder.Write(name, "x");
  }
  const std::string own = folder.File("own.tmp" + std::to_string(getpid()) + "_7");  // of an earlier process
  std::ofstream(own) << "x";
  RemoveTemporaryFiles(folder.path());
  EXPECT_FALSE(std::filesystem::exists(folder.File("a/states.csv.tmp999999999_345")));
  EXPECT_FALSE(std::filesystem::exists(folder.File("b.tmp99999999999999999999_2")));
  EXPECT_FALSE(std::filesystem::exists(own));
  for (const char* name :
       {"a/states.csv", "c.tmp", "d.tmp12_x", "e.tmp1_2.csv", "of_the_process_that_runs_all.tmp1_2"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.File(name))) << name;
  }
}

// GIVEN what killed processes left of a file, and files of others beside it WHEN the file is written THEN the
// former is gone and the latter stand.
TEST(WriteLoneFileAtomically, TakesWhatAKilledProcessLeftOfItsFileAndNothingElse) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> of_others = {
      "rover.pos.tmp1_2",  // of the process that runs all
      "rover.pos.tmp",           "rover.pos.tmp12_x",           "rover.pos.tmp999999999_1.tmp999999999_2",
      "base.pos.tmp999999999_1", "my_rover.pos.tmp999999999_1", "below/rover.pos.tmp999999999_1"};
  for (const std::string& name : of_others) {
    folder.Write(name, "x");
  }
  folder.Write("rover.pos.tmp999999999_345", "x");
  ASSERT_TRUE(WriteLoneFileAtomically(folder.File("rover.pos"), "text").ok());
  EXPECT_EQ(ReadWholeFile(folder.File("rover.pos")).value(), "text");
  EXPECT_FALSE(std::filesystem::exists(folder.File("rover.pos.tmp999999999_345")));
  for (const std::string& name : of_others) {
    EXPECT_TRUE(std::filesystem::exists(folder.File(name))) << name;
  }
}

}  // namespace
}  // namespace alidade
