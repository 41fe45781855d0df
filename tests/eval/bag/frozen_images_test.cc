#include "eval/bag/frozen_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
