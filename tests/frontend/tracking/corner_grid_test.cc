#include "frontend/tracking/corner_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "tests/frontend/tracking/synthetic_scene.h"

namespace alidade {
namespace {

using testing::ElementsAre;

constexpr int kWidthPx = 403;  // no multiple of the columns
constexpr int kHeightPx = 247;
constexpr int kBorderPx = 10;

FrontendConfig SmallConfig() {
  FrontendConfig config;
  config.max_features = 40;
  config.min_distance_px = 12;
  config.grid_columns = 5;
  config.grid_rows = 4;
  config.corner_threshold = 4;
  return config;
}

cv::Mat DerivativesOf(const cv::Mat& image) {
  std::array<cv::Mat, 2> gradient;
  cv::Scharr(image, gradient[0], CV_16S, 1, 0);
  cv::Scharr(image, gradient[1], CV_16S, 0, 1);
  cv::Mat derivatives;
  cv::merge(gradient.data(), 2, derivatives);
  return derivatives;
}

/// A textured image and its Scharr derivatives.
struct Textured {
  std::vector<unsigned char> pixels;
  cv::Mat image;
  cv::Mat derivatives;

  explicit Textured(const std::function<bool(int column)>& blank)
      : pixels(test::Render(kWidthPx, kHeightPx, [](const Eigen::Vector2d& u) { return u; })) {
    for (size_t i = 0; i < pixels.size(); ++i) {
      if (blank(static_cast<int>(i % kWidthPx))) {
        pixels[i] = 80;
      }
    }
    image = cv::Mat(kHeightPx, kWidthPx, CV_8UC1, pixels.data());
    derivatives = DerivativesOf(image);
  }
};

std::map<int, int> CountByColumn(const std::vector<cv::Point2f>& pixels) {
  std::map<int, int> counts;
  for (const cv::Point2f& pixel : pixels) {
    ++counts[static_cast<int>(pixel.x) * 5 / kWidthPx];
  }
  return counts;
}

TEST(CornerGrid, ThinningPrefersTheFirst) {
  const CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  // 5 px apart is nearer than half of 12; 7 px is not.
  EXPECT_THAT(grid.Thin({{100, 100}, {105, 100}, {100, 107}, {300, 100}}),
              ElementsAre(true, false, true, true));
  EXPECT_THAT(grid.Thin({}), ElementsAre());
}

TEST(CornerGrid, FillsTheEmptiestCellsFirst) {
  const Textured scene([](int) { return false; });
  CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  // The left two columns have their share already, 16 features; 24 are left for the 12 cells of the others.
  std::vector<cv::Point2f> existing;
  existing.reserve(16);
  for (int i = 0; i < 16; ++i) {
    const int row = i / 4;
    existing.emplace_back(20.F + 40 * static_cast<float>(i % 4), 20.F + 60 * static_cast<float>(row));
  }
  const std::vector<cv::Point2f> found = grid.Detect(scene.image, scene.derivatives, existing);
  EXPECT_EQ(found.size(), 24U);
  EXPECT_LE(CountByColumn(found)[0] + CountByColumn(found)[1], 1) << "refinement may cross an edge";
  existing.resize(40, cv::Point2f(200, 200));
  EXPECT_TRUE(grid.Detect(scene.image, scene.derivatives, existing).empty());
}

TEST(CornerGrid, BlankCellsGiveTheirShareToOthersUpToTwice) {
  const Textured scene([](int column) { return column > 160; });
  CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  const std::vector<cv::Point2f> found = grid.Detect(scene.image, scene.derivatives, {});
  EXPECT_GT(found.size(), 24U);
  EXPECT_LE(found.size(), 33U);
  for (const cv::Point2f& pixel : found) {
    EXPECT_LT(pixel.x, 170);
    EXPECT_GE(pixel.x, kBorderPx - 4);
    EXPECT_GE(pixel.y, kBorderPx - 4);
    EXPECT_LE(pixel.y, kHeightPx - kBorderPx + 4);
  }
}

TEST(CornerGrid, FindsNothingInABlankOrATinyImage) {
  const Textured scene([](int) { return true; });
  CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  EXPECT_TRUE(grid.Detect(scene.image, scene.derivatives, {}).empty());
  const cv::Rect corner(0, 0, 15, 9);
  CornerGrid tiny(SmallConfig(), corner.width, corner.height, kBorderPx);
  EXPECT_TRUE(tiny.Detect(scene.image(corner).clone(), scene.derivatives(corner).clone(), {}).empty());
}

/// Squares of 12 px, `contrast` above the ground of 60, one in each cell.
cv::Mat Squares(const std::function<int(int column)>& contrast) {
  cv::Mat image(kHeightPx, kWidthPx, CV_8UC1, cv::Scalar(60));
  for (int column = 0; column < 5; ++column) {
    for (int row = 0; row < 4; ++row) {
      image(cv::Rect(80 * column + 30, 61 * row + 25, 12, 12)) = 60 + contrast(column);
    }
  }
  return image;
}

TEST(CornerGrid, GIVEN_strong_corners_elsewhere_THEN_weak_ones_are_refused) {
  const auto on_the_right = [](int left, int right) {
    CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
    const cv::Mat image = Squares([&](int column) { return column < 2 ? left : right; });
    const std::vector<cv::Point2f> found = grid.Detect(image, DerivativesOf(image), {});
    return std::count_if(found.begin(), found.end(), [](const cv::Point2f& pixel) { return pixel.x > 170; });
  };
  EXPECT_EQ(on_the_right(180, 9), 0);
  EXPECT_GE(on_the_right(9, 9), 12) << "a dull image has no better ones";
  EXPECT_GE(on_the_right(180, 90), 12);
}

TEST(CornerGrid, GIVEN_strong_tracks_THEN_weak_corners_are_refused_as_beside_strong_corners) {
  CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  const cv::Mat image = Squares([](int column) { return column < 2 ? 180 : 9; });
  // The tracks fill the left cells: these are not searched.
  std::vector<cv::Point2f> existing;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 2; ++column) {
      for (const int corner : {0, 12}) {
        existing.emplace_back(static_cast<float>(80 * column + 30 + corner),
                              static_cast<float>(61 * row + 25));
      }
    }
  }
  EXPECT_TRUE(grid.Detect(image, DerivativesOf(image), existing).empty());
}

TEST(CornerGrid, GIVEN_a_bare_cell_THEN_it_rests_and_is_searched_again) {
  CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  const cv::Mat bare(kHeightPx, kWidthPx, CV_8UC1, cv::Scalar(60));
  const cv::Mat squares = Squares([](int) { return 120; });
  // More than half of 40 features, in the upper left cell, so that there is no need to hurry.
  const std::vector<cv::Point2f> existing(25, cv::Point2f(30, 25));
  EXPECT_TRUE(grid.Detect(bare, DerivativesOf(bare), existing).empty());
  for (int k = 0; k < CornerGrid::kRestImages; ++k) {
    EXPECT_TRUE(grid.Detect(squares, DerivativesOf(squares), existing).empty()) << k;
  }
  EXPECT_EQ(grid.Detect(squares, DerivativesOf(squares), existing).size(), 15U);
  EXPECT_TRUE(grid.Detect(bare, DerivativesOf(bare), existing).empty());
  EXPECT_GE(grid.Detect(squares, DerivativesOf(squares), {}).size(), 20U)
      << "without features all are searched";
}

TEST(CornerGrid, GIVEN_white_out_beside_a_corner_THEN_it_is_refused) {
  CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  const cv::Mat bright = Squares([](int) { return 180; });
  EXPECT_FALSE(grid.Detect(bright, DerivativesOf(bright), {}).empty());
  const cv::Mat saturated = Squares([](int) { return 195; });
  EXPECT_TRUE(grid.Detect(saturated, DerivativesOf(saturated), {}).empty());
}

TEST(CornerGrid, RefinesACornerToTheMeetingPointOfItsEdges) {
  // A bright quadrant whose edges lie at x = 200.3 and y = 120.6, drawn with partly covered pixels.
  cv::Mat image(kHeightPx, kWidthPx, CV_8UC1);
  for (int row = 0; row < kHeightPx; ++row) {
    for (int column = 0; column < kWidthPx; ++column) {
      const double covered =
          std::clamp(column + 0.5 - 200.3, 0.0, 1.0) * std::clamp(row + 0.5 - 120.6, 0.0, 1.0);
      image.at<unsigned char>(row, column) = static_cast<unsigned char>(40 + 160 * covered);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(5, 5), 1);
  const cv::Mat derivatives = DerivativesOf(image);
  CornerGrid grid(SmallConfig(), kWidthPx, kHeightPx, kBorderPx);
  const std::vector<cv::Point2f> found = grid.Detect(image, derivatives, {});
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(found.front().x, 200.3, 0.4);
  EXPECT_NEAR(found.front().y, 120.6, 0.4);
}

}  // namespace
}  // namespace alidade
