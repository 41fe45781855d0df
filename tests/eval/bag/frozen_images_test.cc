#include "eval/bag/frozen_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "core/check.h"
#include "eval/dataset/png_image.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

/// Images of 8 x 6 px; `different`: the index of one that differs in a pixel, -1: none does.
Dataset WithImages(const test::TemporaryFolder& folder, int count, int different) {
  Dataset dataset;
  for (int i = 0; i < count; ++i) {
    GreyImage image{8, 6, std::vector<unsigned char>(48, 100)};
    image.pixels[5] = i == different ? 101 : 100;
    const std::string path = folder.File(std::to_string(i) + ".png");
    CHECK(WritePng(image, path).ok());
    dataset.images.push_back({i * kSecondNs, path});
  }
  return dataset;
}

std::vector<DatasetFinding> FindingsOf(const Dataset& dataset) {
  Findings findings;
  CheckFrozenImages(dataset, &findings);
  return findings.Take();
}

TEST(FrozenImages, GivenACameraThatRepeatsOneImageThenItIsAnError) {
  const test::TemporaryFolder folder;
  const std::vector<DatasetFinding> found = FindingsOf(WithImages(folder, 20, -1));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].severity, DatasetFinding::Severity::kError);
  EXPECT_THAT(found[0].text,
              testing::HasSubstr("cam0: 8 images, sampled evenly from 20, are equal to the pixel"));
}

// GIVEN GNSS or fixes, with which an estimator may do without the camera, THEN it is a warning; GIVEN tracks,
// with which the images are not used, THEN nothing is said.
TEST(FrozenImages, GivenAnotherUseThenItIsNoError) {
  const test::TemporaryFolder folder;
  const Dataset frozen = WithImages(folder, 20, -1);
  Dataset gnss = frozen, fixes = frozen, tracks = frozen;
  gnss.gnss = std::make_shared<GnssLog>();
  fixes.fixes.emplace_back();
  for (const Dataset& dataset : {gnss, fixes}) {
    const std::vector<DatasetFinding> found = FindingsOf(dataset);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].severity, DatasetFinding::Severity::kWarning);
  }
  tracks.frames.push_back({0, {{1, Eigen::Vector2d(5, 5)}}, 0});
  EXPECT_TRUE(FindingsOf(tracks).empty());
}

/// An IMU of 100 Hz that is turned at 1 rad/s between the given times and rests before and after.
void AddImu(double from_s, double to_s, Dataset* dataset) {
  for (int i = -500; i < 2500; ++i) {
    const double t = 0.01 * i;
    const double rate = t >= from_s && t < to_s ? 1 : 0;
    dataset->imu.push_back({i * TimeNs{10'000'000}, Eigen::Vector3d(0, 0, rate), Eigen::Vector3d(0, 0, 9.8)});
  }
}

// GIVEN equal images WHEN the IMU rests from the first to the last of them THEN it is a warning; WHEN it
// does not, by the camera's clock, THEN an error.
TEST(FrozenImages, GivenAnImuAtRestThenItIsAWarning) {
  const test::TemporaryFolder folder;
  const Dataset frozen = WithImages(folder, 20, -1);  // over 19 s
  struct Motion {
    double from_s, to_s, offset_s;
    DatasetFinding::Severity severity;
  };
  using enum DatasetFinding::Severity;
  for (const Motion& motion :
       {Motion{-9, -9, 0, kWarning}, Motion{19.5, 30, 0, kWarning}, Motion{5, 15, 0, kError},
        Motion{0.1, 0.2, 0, kWarning}, Motion{19.5, 30, 5, kError}}) {
    Dataset dataset = frozen;
    dataset.rig.camera_time_offset_s = motion.offset_s;
    AddImu(motion.from_s, motion.to_s, &dataset);
    const std::vector<DatasetFinding> found = FindingsOf(dataset);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].severity, motion.severity) << motion.from_s << " " << motion.offset_s;
  }
}

TEST(FrozenImages, GivenOneThatDiffersOrOnlyTwoThenNothingIsSaid) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(FindingsOf(WithImages(folder, 20, 19)).empty()) << "the last is in the sample";
  EXPECT_TRUE(FindingsOf(WithImages(folder, 2, -1)).empty());
}

TEST(FrozenImages, GivenImagesThatCannotBeReadThenTheOthersAreCompared) {
  const test::TemporaryFolder folder;
  Dataset dataset = WithImages(folder, 8, -1);
  folder.Write("0.png", "torn");
  EXPECT_EQ(FindingsOf(dataset).size(), 1u);
  for (int i = 1; i < 6; ++i) {
    folder.Write(std::to_string(i) + ".png", "torn");
  }
  EXPECT_TRUE(FindingsOf(dataset).empty()) << "two are left";
}

}  // namespace
}  // namespace alidade
