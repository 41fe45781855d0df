#include "eval/calibrate/provisional_sheets.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade::test {
namespace {

namespace fs = std::filesystem;

// GIVEN what a process that was killed left of its staging: links, some of them to another sequence, and half
// of a folder WHEN a sequence is staged THEN it is complete, with its own files alone.
TEST(CompleteSheets, ReplacesWhatAKilledProcessLeft) {
  const TemporaryFolder folder;
  folder.Write("other/data.csv", "of another");
  folder.Write("sequence/mav0/imu0/data.csv", "samples");
  folder.Write("staging/mav0/imu0/stale.csv", "x");
  fs::create_symlink(folder.File("other/data.csv"), folder.File("staging/mav0/imu0/data.csv"));
  const Result<ProvisionalSequence> sequence =
      CompleteSheets(folder.File("sequence"), folder.File("staging"));
  ASSERT_TRUE(sequence.ok()) << sequence.message();
  EXPECT_TRUE(sequence->imu_noise);
  EXPECT_EQ(sequence->path, folder.File("staging"));
  EXPECT_EQ(ReadFile(folder.File("staging/mav0/imu0/data.csv")), "samples");
  EXPECT_TRUE(fs::exists(folder.File("staging/mav0/imu0/sensor.yaml")));
  EXPECT_FALSE(fs::exists(folder.File("staging/mav0/imu0/stale.csv")));
  EXPECT_EQ(ReadFile(folder.File("other/data.csv")), "of another");
}

}  // namespace
}  // namespace alidade::test
