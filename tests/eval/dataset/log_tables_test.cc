#include "eval/dataset/log_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/dataset/dataset_check.h"
#include "eval/dataset/dataset_reader.h"
#include "eval/dataset/digest.h"
#include "tests/support/good_sequence.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

std::vector<std::string> FindingsOf(const Dataset& dataset) {
  std::vector<std::string> texts;
  for (const DatasetFinding& finding : CheckDataset(dataset)) {
    texts.push_back(finding.text);
  }
  return texts;
}

std::string DigestOfTables(const Dataset& dataset) {
  return DigestOf(MeasurementsOf(dataset), TablesOf(dataset)).value();
}

/// 60 s at 200 Hz with faulty rows, 10 Hz of tracks, frames that saw nothing, a second camera, truth at 20
/// Hz.
void WriteSequence(const test::TemporaryFolder& folder) {
  test::WriteGoodSequence(folder);
  std::string imu = test::kImuHeader, tracks = "#timestamp [ns],track_id,u [px],v [px],noise_ratio\n",
              stamps = "#timestamp [ns]\n";
  std::string truth = test::kTruthHeader;
  const auto sample = [](long long ns, int value) {
    return std::to_string(ns) + ",0.1,0,0.3," + std::to_string(value % 7) + ",0,9.81\n";
  };
  for (int i = 0; i < 12'000; ++i) {
    imu += sample(1000 + 5'000'000LL * (i % 10 == 3 ? i + 1 : i % 10 == 4 ? i - 1 : i), i);  // two swapped
    imu += i % 500 == 7 ? sample(1000 + 5'000'000LL * (i - 2), i) : "";                      // twice
    imu += i % 500 == 9 ? sample(1000 + 5'000'000LL * (i - 30), i) : "";                     // late
  }
  for (int i = 0; i < 600; ++i) {
    const std::string stamp = std::to_string(1000 + 100'000'000LL * i);
    stamps += stamp + "\n";
    for (int k = 0; k < 40 && i % 10 != 5; ++k) {
      tracks += stamp + "," + std::to_string(i / 5 + k) + "," + std::to_string(10 + k) + ".25,20," +
                std::to_string(1 + k % 3) + "\n";
    }
    truth += stamp + "," + std::to_string(0.01 * i) + ",0,0,1,0,0,0\n";
  }
  folder.Write("mav0/imu0/data.csv", imu);
  folder.Write("mav0/cam0/tracks.csv", tracks);
  folder.Write("mav0/cam0/timestamps.csv", stamps);
  folder.Write("mav0/cam1/sensor.yaml", test::CameraYaml(test::kIdentity, test::kNoLens));
  folder.Write("mav0/cam1/tracks.csv", std::string(test::kTracksHeader) + "1000,1,10,20\n2000,1,11,21\n");
  folder.Write("mav0/state_groundtruth_estimate0/data_pose.csv", truth);
}

// GIVEN a sequence that is read into files, THEN it is that which is read into memory: digest, findings,
// counts.
TEST(LogTables, OfFilesAreThoseOfMemory) {
  const test::TemporaryFolder folder;
  WriteSequence(folder);
  const Result<Dataset> held = ReadDataset(folder.path());
  ASSERT_TRUE(held.ok()) << held.message();
  ASSERT_EQ(held->frames.size(), 600u);
  ASSERT_GT(held->imu_rejections.dropped(), 20u);
  const test::TemporaryFolder spool;
  const Result<Dataset> read = ReadDataset(folder.path(), {spool.path(), 5});
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_TRUE(read->imu.empty() && read->frames.empty() && read->extra_cameras.at(0).frames.empty());
  EXPECT_EQ(read->tables->imu.size(), held->imu.size());
  EXPECT_EQ(read->tables->frames.size(), held->frames.size());
  EXPECT_EQ(DigestOfTables(*read), DigestOf(MeasurementsOf(*held)));
  EXPECT_EQ(FindingsOf(*read), FindingsOf(*held));
  EXPECT_EQ(read->remarks, held->remarks);
  EXPECT_EQ(read->imu_rate_hz, held->imu_rate_hz);
  EXPECT_EQ(read->camera_rate_hz, held->camera_rate_hz);

  Dataset moved = *held;
  ASSERT_TRUE(MoveTablesToFiles(spool.path(), &moved).ok());
  EXPECT_TRUE(moved.imu.empty() && moved.frames.empty());
  EXPECT_EQ(DigestOfTables(moved), DigestOfTables(*read));
}

// Of the truth, first and last pose stay, and those a start may ask for.
TEST(LogTables, KeepOfTheTruthWhatAStartNeeds) {
  const test::TemporaryFolder folder;
  WriteSequence(folder);
  const Result<Dataset> read = ReadDataset(folder.path(), {folder.path(), 5});
  ASSERT_TRUE(read.ok()) << read.message();
  const std::vector<TrajectoryPoint>& points = read->truth->points;
  ASSERT_EQ(read->truth_extent->stamps.size(), 600u);
  EXPECT_EQ(points.front().stamp_ns, read->truth_extent->stamps.front());
  EXPECT_EQ(points.back().stamp_ns, read->truth_extent->stamps.back());
  EXPECT_EQ(points[points.size() - 2].stamp_ns, 1000 + 15 * kSecondNs);
  EXPECT_NEAR(read->truth_extent->path_m, 5.99, 1e-9);
}

TEST(LogTables, GivenAFaultThenItIsReportedAsOfMemory) {
  const test::TemporaryFolder folder;
  WriteSequence(folder);
  for (const auto& [name, text] :
       {std::pair("mav0/cam0/tracks.csv", std::string(test::kTracksHeader) + "77,1,2,3\n"),
        std::pair("mav0/imu0/data.csv", std::string(test::kImuHeader) + "77,1,2\n")}) {
    folder.Write(name, text);
    EXPECT_EQ(ReadDataset(folder.path(), {folder.path(), 5}).message(), ReadDataset(folder.path()).message());
    EXPECT_FALSE(ReadDataset(folder.path()).ok());
  }
}

}  // namespace
}  // namespace alidade
