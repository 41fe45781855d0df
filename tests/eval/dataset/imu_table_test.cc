// Rows of an IMU table that are out of order, repeated or not finite.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_check.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/dataset_writer.h"
#include "tests/support/good_sequence.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using test::kImuHeader;
using test::WriteGoodSequence;
using testing::HasSubstr;

/// Rows of a still IMU at 200 Hz from stamp 1000.
std::vector<std::string> StillRows(int count) {
  std::vector<std::string> rows;
  rows.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    rows.push_back(std::to_string(1000 + 5'000'000LL * i) + ",0,0,0,0,0," + std::to_string(9 + i % 2) + "\n");
  }
  return rows;
}

std::string Joined(const std::vector<std::string>& rows) {
  std::string text;
  for (const std::string& row : rows) {
    text += row;
  }
  return text;
}

TEST(FaultyImuRows, GivenFewOfThemThenTheSamplesAreThoseOfACleanFileAndTheyAreCounted) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  folder.Write("mav0/imu0/data.csv", kImuHeader + Joined(StillRows(100)));
  const Result<Dataset> clean = ReadDataset(folder.path());
  ASSERT_TRUE(clean.ok()) << clean.message();
  EXPECT_TRUE(clean->remarks.empty());

  std::vector<std::string> rows = StillRows(100);
  std::swap(rows[20], rows[25]);             // five of them come after a later stamp
  rows.insert(rows.begin() + 11, rows[10]);  // a duplicate
  rows.insert(rows.begin() + 60, rows[40]);  // 80 ms late
  rows.insert(rows.begin() + 70, "350001500,nan,0,0,0,0,9\n");
  folder.Write("mav0/imu0/data.csv", kImuHeader + Joined(rows));
  const Result<Dataset> faulty = ReadDataset(folder.path());
  ASSERT_TRUE(faulty.ok()) << faulty.message();
  EXPECT_EQ(faulty->imu_rejections.duplicate, 1u);
  EXPECT_EQ(faulty->imu_rejections.late, 1u);
  EXPECT_EQ(faulty->imu_rejections.not_finite, 1u);
  EXPECT_EQ(faulty->imu_rejections.reordered, 5u);
  ASSERT_EQ(faulty->imu.size(), clean->imu.size());
  for (size_t i = 0; i < clean->imu.size(); ++i) {
    EXPECT_EQ(faulty->imu[i].stamp_ns, clean->imu[i].stamp_ns);
    EXPECT_EQ(faulty->imu[i].accel, clean->imu[i].accel);
  }
  ASSERT_EQ(faulty->remarks.size(), 1u);
  EXPECT_THAT(
      faulty->remarks[0],
      testing::AllOf(HasSubstr("data.csv: of 103 rows 3 dropped (1 duplicate, 1 late, 1 not finite), 5 "
                               "put in order"),
                     HasSubstr("data.csv:13: ")));
  bool reported = false;
  for (const DatasetFinding& finding : CheckDataset(*faulty)) {
    reported = reported || finding.text.find("rows 3 dropped") != std::string::npos;
  }
  EXPECT_TRUE(reported);
}

// GIVEN a clock that is set back by 0.2 s, THEN the samples are those of a clock that is not.
TEST(FaultyImuRows, GivenAClockThatIsSetBackThenLaterStampsAreMoved) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  folder.Write("mav0/imu0/data.csv", kImuHeader + Joined(StillRows(200)));
  const Result<Dataset> clean = ReadDataset(folder.path());
  ASSERT_TRUE(clean.ok()) << clean.message();
  std::vector<std::string> rows = StillRows(160);
  const std::vector<std::string> back(rows.begin() + 60, rows.end());
  rows.erase(rows.begin() + 100, rows.end());
  rows.insert(rows.end(), back.begin(), back.end());
  folder.Write("mav0/imu0/data.csv", kImuHeader + Joined(rows));
  const Result<Dataset> set_back = ReadDataset(folder.path());
  ASSERT_TRUE(set_back.ok()) << set_back.message();
  EXPECT_EQ(set_back->imu_rejections.dropped(), 0u);
  EXPECT_NEAR(set_back->imu_rejections.set_back_s, 0.2, 1e-9);
  ASSERT_EQ(set_back->imu.size(), clean->imu.size());
  for (size_t i = 0; i < clean->imu.size(); ++i) {
    ASSERT_EQ(set_back->imu[i].stamp_ns, clean->imu[i].stamp_ns) << i;
    ASSERT_EQ(set_back->imu[i].accel, clean->imu[i].accel) << i;
  }
  ASSERT_EQ(set_back->remarks.size(), 1u);
  EXPECT_THAT(set_back->remarks[0],
              testing::AllOf(HasSubstr("data.csv: of 200 rows the clock set back by 0.200 s"),
                             HasSubstr("data.csv:102: found stamp")));
}

// GIVEN samples that are delayed by 0.2 s, THEN they are dropped, and later ones keep their stamps.
TEST(FaultyImuRows, GivenADelayedBlockThenTheClockWasNotSetBack) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  std::vector<std::string> rows = StillRows(400);
  std::rotate(rows.begin() + 100, rows.begin() + 112, rows.begin() + 160);  // twelve rows
  folder.Write("mav0/imu0/data.csv", kImuHeader + Joined(rows));
  const Result<Dataset> delayed = ReadDataset(folder.path());
  ASSERT_TRUE(delayed.ok()) << delayed.message();
  EXPECT_EQ(delayed->imu_rejections.late, 12u);
  EXPECT_EQ(delayed->imu_rejections.set_back_s, 0);
  EXPECT_EQ(delayed->imu.back().stamp_ns, 1000 + 399 * 5'000'000LL);
}

TEST(FaultyImuRows, GivenMoreThanFivePerCentThenTheSequenceIsRefused) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  std::vector<std::string> rows = StillRows(100);
  for (int i = 0; i < 6; ++i) {
    rows.push_back(rows.back());
  }
  folder.Write("mav0/imu0/data.csv", kImuHeader + Joined(rows));
  const Result<Dataset> dataset = ReadDataset(folder.path());
  EXPECT_EQ(dataset.code(), StatusCode::kInput);
  EXPECT_THAT(dataset.message(),
              testing::AllOf(HasSubstr("data.csv:102: "), HasSubstr("of 106 rows 6 dropped")));
}

TEST(ImuSheet, IsNotWrittenWithANoiseThatNoReaderTakes) {
  const test::TemporaryFolder folder;
  WriteGoodSequence(folder);
  Result<Dataset> dataset = ReadDataset(folder.path());
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  dataset->rig.imu_noise.accel_noise_density_mps2_sqrthz = 0;
  const Status status = WriteDataset(*dataset, folder.File("copy"));
  EXPECT_EQ(status.code(), StatusCode::kConfig);
  EXPECT_THAT(status.message(), HasSubstr("expected both greater than 0"));
}

}  // namespace
}  // namespace alidade
