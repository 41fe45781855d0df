#include "frontend/tracking/image_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(ReadGreyImage, ReadsEightBits) {
  const test::TemporaryFolder folder;
  const Result<GreyImage> image = ReadGreyImage(
      folder.Write("small.pgm", std::string("P5\n3 2\n255\n") + std::string("\x00\x01\x7f\x80\xfe\xff", 6)));
  ASSERT_TRUE(image.ok()) << image.message();
  EXPECT_EQ(image->width_px, 3);
  EXPECT_EQ(image->height_px, 2);
  EXPECT_THAT(image->pixels, ElementsAre(0, 1, 127, 128, 254, 255));
}

TEST(ReadGreyImage, ScalesSixteenBitsToEight) {
  const test::TemporaryFolder folder;
  const Result<GreyImage> image = ReadGreyImage(folder.Write(
      "deep.pgm", std::string("P5\n4 1\n65535\n") + std::string("\x00\x00\x01\x01\xc0\xff\xff\xff", 8)));
  ASSERT_TRUE(image.ok()) << image.message();
  EXPECT_THAT(image->pixels, ElementsAre(0, 1, 192, 255));
}

TEST(ReadGreyImage, NamesThePathOfWhatItCannotRead) {
  const test::TemporaryFolder folder;
  const auto expect_refused = [](const std::string& path) {
    const Result<GreyImage> image = ReadGreyImage(path);
    EXPECT_EQ(image.code(), StatusCode::kInput) << path;
    EXPECT_THAT(image.message(), HasSubstr(path));
  };
  expect_refused(folder.File("absent.png"));
  expect_refused(folder.path());
  expect_refused(folder.Write("empty.png", ""));
  expect_refused(folder.Write("letter.png", "Dear reader, this is not an image."));
  expect_refused(folder.Write("torn.pgm", "P5\n300 200\n255\nabc"));
}

TEST(ReadGreyImage, RefusesATornPng) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::filesystem::path whole = std::filesystem::path(test::SharedDir()) /
                                      "data/euroc_micro/V1_01_first95/mav0/cam0/data/1403715273262142976.png";
  const Result<GreyImage> image = ReadGreyImage(whole.string());
  ASSERT_TRUE(image.ok()) << image.message();
  EXPECT_EQ(image->width_px, 752);
  EXPECT_EQ(image->height_px, 480);
  EXPECT_EQ(image->pixels.size(), 752U * 480U);
  std::ifstream file(whole, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const test::TemporaryFolder folder;
  EXPECT_FALSE(ReadGreyImage(folder.Write("torn.png", bytes.substr(0, bytes.size() / 2))).ok());
}

}  // namespace
}  // namespace alidade
