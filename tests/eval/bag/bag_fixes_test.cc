#include "eval/bag/bag_fixes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/bag/bag_export.h"
#include "eval/bag/bag_import.h"
#include "eval/rosbag/ros_header.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;

constexpr TimeNs kStart = 1'700'000'000'000'000'000;

Dataset WithFixes() {
  Dataset dataset;
  dataset.imu_rate_hz = 100;
  for (int i = 0; i <= 300; ++i) {
    dataset.imu.push_back({kStart + i * TimeNs{10'000'000}, Vector3d(1e-4 * i, 0.1, 0), Vector3d(0, 0, 9.8)});
  }
  dataset.rig.fixes = {{Vector3d(0.1, -0.2, 0.3), 0.25, Vector3d(47.4, 8.5, 450)},
                       {Vector3d(0, 0, 1), 0, std::nullopt}};
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix3d covariance = Vector3d(1.1, 0.9, 2.0).asDiagonal();
    covariance(0, 1) = covariance(1, 0) = 0.3;
    dataset.fixes.push_back(
        {kStart + i * TimeNs{400'000'000}, i % 2, Vector3d(500 - i, 30 * i, 5), covariance});
  }
  return dataset;
}

TEST(BagFixes, WHEN_written_and_read_THEN_own_frames_are_equal_and_geodetic_ones_to_rounding) {
  const test::TemporaryFolder folder;
  const Dataset written = WithFixes();
  const std::string path = folder.File("fixes.bag");
  ASSERT_TRUE(WriteBag(written, {}, path).ok());
  const Result<BagImport> import = ReadBag(path, {});
  ASSERT_TRUE(import.ok()) << import.message();
  const Dataset& read = import->dataset;
  ASSERT_EQ(read.rig.fixes.size(), 2u);
  EXPECT_EQ(read.rig.fixes[0].anchor_llh_deg, written.rig.fixes[0].anchor_llh_deg);
  EXPECT_EQ(read.rig.fixes[0].time_offset_s, 0.25);
  EXPECT_EQ(read.rig.fixes[1].p_BA, Vector3d(0, 0, 1));
  ASSERT_EQ(read.fixes.size(), written.fixes.size());
  std::vector<PositionFix> expected = written.fixes;
  std::stable_sort(expected.begin(), expected.end(),
                   [](const auto& a, const auto& b) { return a.sensor < b.sensor; });
  std::vector<PositionFix> found = read.fixes;
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.sensor < b.sensor; });
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(found[i].stamp_ns, expected[i].stamp_ns);
    const double tolerance = expected[i].sensor == 0 ? 1e-7 : 0;
    EXPECT_LE((found[i].p_A - expected[i].p_A).norm(), tolerance);
    EXPECT_LE((found[i].covariance - expected[i].covariance).norm(), tolerance);
  }
}

TEST(BagFixes, GIVEN_a_topic_of_another_name_THEN_it_is_read_when_it_is_named_and_else_remarked) {
  const test::TemporaryFolder folder;
  BagExportOptions options;
  options.topics = "fix=/gps/fix";
  const std::string path = folder.File("named.bag");
  Dataset dataset = WithFixes();
  dataset.rig.fixes.resize(1);
  std::erase_if(dataset.fixes, [](const PositionFix& fix) { return fix.sensor == 1; });
  ASSERT_TRUE(WriteBag(dataset, options, path).ok());
  const Result<BagImport> unnamed = ReadBag(path, {});
  ASSERT_TRUE(unnamed.ok()) << unnamed.message();
  EXPECT_TRUE(unnamed->dataset.fixes.empty());
  EXPECT_THAT(unnamed->remarks, Contains(HasSubstr("--topics=fix=/gps/fix")));
  BagImportOptions named;
  named.topics = "fix=/gps/fix";
  const Result<BagImport> import = ReadBag(path, named);
  ASSERT_TRUE(import.ok()) << import.message();
  EXPECT_EQ(import->dataset.fixes.size(), 3u);
  BagImportOptions missing;
  missing.topics = "fix=/gps/none";
  EXPECT_THAT(ReadBag(path, missing).message(), HasSubstr("no topic /gps/none"));
}

TEST(NavSatFixMessage, GIVEN_its_covariance_type_THEN_the_covariance_is_what_is_known) {
  NavSatFix fix{kStart, Vector3d(47, 8, 400), Vector3d(1, 2, 3).asDiagonal()};
  fix.covariance_N(0, 1) = fix.covariance_N(1, 0) = 0.5;
  const std::string bytes = EncodeNavSatFix(fix);
  const auto with = [&](std::size_t position, char value) {
    std::string changed = bytes;
    changed[position] = value;
    return DecodeNavSatFix(changed);
  };
  const std::size_t type = bytes.size() - 1;
  constexpr std::size_t kStatus = 16;  // after sequence, time and an empty frame
  EXPECT_EQ(DecodeNavSatFix(bytes).fix->covariance_N, fix.covariance_N);
  EXPECT_EQ(with(type, 2).fix->covariance_N(0, 1), 0);
  EXPECT_EQ(with(type, 0).fix->covariance_N(2, 2), 36);
  EXPECT_FALSE(with(type, 9).sound);
  EXPECT_TRUE(with(kStatus, -1).sound);
  EXPECT_FALSE(with(kStatus, -1).fix);
  EXPECT_FALSE(DecodeNavSatFix(bytes.substr(0, bytes.size() - 1)).sound);
}

}  // namespace
}  // namespace alidade
