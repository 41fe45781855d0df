#include "frontend/tracking/corner_strength.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace alidade {
namespace {

constexpr int kSidePx = 60;

cv::Mat DerivativesOf(const cv::Mat& image) {
  std::array<cv::Mat, 2> gradient;
  cv::Scharr(image, gradient[0], CV_16S, 1, 0);
  cv::Scharr(image, gradient[1], CV_16S, 0, 1);
  cv::Mat derivatives;
  cv::merge(gradient.data(), 2, derivatives);
  return derivatives;
}

/// A bright rectangle from (x, y) to the lower right on a ground of 60.
cv::Mat Step(int x, int y, int contrast) {
  cv::Mat image(kSidePx, kSidePx, CV_8UC1, cv::Scalar(60));
  image(cv::Rect(x, y, kSidePx - x, kSidePx - y)) = 60 + contrast;
  return image;
}

const cv::Rect kInside(4, 4, kSidePx - 8, kSidePx - 8);

TEST(CornerStrength, GIVEN_a_right_angle_THEN_its_strength_is_that_of_its_contrast) {
  for (const int contrast : {10, 40, 160}) {
    const std::vector<Corner> found =
        corner_strength::Maxima(DerivativesOf(Step(30, 20, contrast)), kInside, 1);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].pixel.x, 30, 2);
    EXPECT_NEAR(found[0].pixel.y, 20, 2);
    const double ratio =
        static_cast<double>(found[0].strength) / static_cast<double>(corner_strength::OfContrast(contrast));
    EXPECT_GT(std::sqrt(ratio), 0.6) << contrast;
    EXPECT_LT(std::sqrt(ratio), 1.4) << contrast;
  }
}

TEST(CornerStrength, GIVEN_straight_edges_of_any_direction_THEN_there_is_no_corner) {
  for (const double angle : {0.0, 0.2, 0.7, 1.2, 1.57}) {
    cv::Mat image(kSidePx, kSidePx, CV_8UC1);
    for (int y = 0; y < kSidePx; ++y) {
      for (int x = 0; x < kSidePx; ++x) {
        const double beyond = std::cos(angle) * (x - 30) + std::sin(angle) * (y - 30);
        image.at<unsigned char>(y, x) =
            static_cast<unsigned char>(40 + 180 * std::clamp(beyond + 0.5, 0.0, 1.0));
      }
    }
    EXPECT_TRUE(
        corner_strength::Maxima(DerivativesOf(image), kInside, corner_strength::OfContrast(5)).empty())
        << angle;
  }
}

TEST(CornerStrength, GIVEN_an_area_THEN_its_maxima_are_those_of_the_plain_definition) {
  cv::Mat image(kSidePx, kSidePx, CV_8UC1);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(image, image, cv::Size(7, 7), 2);
  const cv::Mat derivatives = DerivativesOf(image);
  const cv::Rect area(7, 9, 40, 33);
  const std::vector<Corner> found = corner_strength::Maxima(derivatives, area, 1);
  ASSERT_GE(found.size(), 5U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const cv::Point place = found[i].pixel;
    EXPECT_TRUE(area.contains(place));
    EXPECT_FLOAT_EQ(found[i].strength, corner_strength::At(derivatives, place));
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        // A neighbour that is an edge does not count as stronger.
        EXPECT_LE(corner_strength::At(derivatives, place + cv::Point(dx, dy)), 1.5F * found[i].strength);
      }
    }
    EXPECT_TRUE(i == 0 || found[i - 1].strength >= found[i].strength) << "strongest first";
  }
}

TEST(CornerStrength, GIVEN_an_empty_area_THEN_there_is_none) {
  EXPECT_TRUE(corner_strength::Maxima(DerivativesOf(Step(30, 20, 90)), cv::Rect(), 1).empty());
}

}  // namespace
}  // namespace alidade
