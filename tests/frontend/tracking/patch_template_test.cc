#include "frontend/tracking/patch_template.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "core/frontend_config.h"
#include "frontend/tracking/feature_track.h"
#include "tests/frontend/tracking/synthetic_scene.h"

namespace alidade {
namespace {

using Eigen::Matrix2f;
using Eigen::Vector2d;
using Eigen::Vector2f;

constexpr int kSizePx = 120;
const int kSidePx = FrontendConfig().template_px;
const Vector2f kCorner(60.3F, 58.8F);

/// The texture seen through q -> texture(from(q)); gain and offset of its grey values.
cv::Mat ImageOf(const std::function<Vector2d(const Vector2d&)>& from, double gain = 1, double offset = 0) {
  const std::vector<unsigned char> pixels = test::Render(kSizePx, kSizePx, from);
  cv::Mat image(kSizePx, kSizePx, CV_8UC1);
  for (int i = 0; i < kSizePx * kSizePx; ++i) {
    const double grey = gain * static_cast<double>(pixels[static_cast<size_t>(i)]) + offset;
    image.at<unsigned char>(i / kSizePx, i % kSizePx) = static_cast<unsigned char>(std::lround(grey));
  }
  return image;
}

const auto kAsItIs = [](const Vector2d& u) { return u; };

/// An image in which what was at kCorner + x lies at kCorner + shift + affine x.
cv::Mat Deformed(const Matrix2f& affine, const Vector2f& shift, double gain = 1, double offset = 0) {
  const Eigen::Matrix2d inverse = affine.cast<double>().inverse();
  const Vector2d corner = kCorner.cast<double>();
  return ImageOf(
      [=](const Vector2d& u) -> Vector2d { return corner + inverse * (u - corner - shift.cast<double>()); },
      gain, offset);
}

TEST(PatchTemplate, FindsAnAffineDeformationToAHundredthOfAPixel) {
  const PatchTemplate patch(ImageOf(kAsItIs), kCorner, kSidePx);
  Matrix2f affine;
  affine << 1.12F, -0.15F, 0.1F, 0.93F;
  const Vector2f shift(0.8F, -0.6F);
  TemplateMatch match{.centre = kCorner, .affine = Matrix2f::Identity(), .correlation = 0};
  ASSERT_TRUE(patch.Align(Deformed(affine, shift), &match));
  EXPECT_LT((match.centre - kCorner - shift).norm(), 0.03F);
  EXPECT_LT((match.affine - affine).norm(), 0.03F);
  EXPECT_GT(match.correlation, 0.99F);
}

TEST(PatchTemplate, GainAndOffsetDoNotMatter) {
  const PatchTemplate patch(ImageOf(kAsItIs), kCorner, kSidePx);
  const Vector2f shift(0.4F, 0.7F);
  TemplateMatch plain{.centre = kCorner, .affine = Matrix2f::Identity(), .correlation = 0};
  TemplateMatch dim = plain;
  ASSERT_TRUE(patch.Align(Deformed(Matrix2f::Identity(), shift), &plain));
  ASSERT_TRUE(patch.Align(Deformed(Matrix2f::Identity(), shift, 0.4, 60), &dim));
  EXPECT_LT((dim.centre - plain.centre).norm(), 0.03F);
  EXPECT_GT(dim.correlation, 0.98F);
}

// GIVEN a corner at the edge of a near surface, WHEN the far one behind it moves otherwise, THEN the corner's
// own surface decides.
TEST(PatchTemplate, WhatLiesFarFromTheCornerCountsLittle) {
  float sum = 0;
  for (int i = 0; i < 16; ++i) {
    const int row = i / 4;
    const Vector2f corner(36.3F + 16 * static_cast<float>(i % 4), 36.8F + 16 * static_cast<float>(row));
    const PatchTemplate patch(ImageOf(kAsItIs), corner, kSidePx);
    const cv::Mat parted = ImageOf([&](const Vector2d& u) -> Vector2d {
      return u.x() < static_cast<double>(corner.x()) + 5 ? u : Vector2d(u.x() + 1, u.y() + 1);
    });
    TemplateMatch match{.centre = corner, .affine = Matrix2f::Identity(), .correlation = 0};
    ASSERT_TRUE(patch.Align(parted, &match));
    sum += (match.centre - corner).norm();
  }
  EXPECT_LT(sum / 16, 0.32F);  // 0.40 without weights
}

// GIVEN a far surface that moves on behind the corner's own THEN the deviation tells.
TEST(PatchTemplate, ADifferenceOfThePatchesIsSeenInTheDeviation) {
  const PatchTemplate patch(ImageOf(kAsItIs), kCorner, kSidePx);
  TemplateMatch same{.centre = kCorner, .affine = Matrix2f::Identity(), .correlation = 0};
  ASSERT_TRUE(patch.Align(ImageOf(kAsItIs), &same));
  float before_px = same.deviation_px;
  EXPECT_LT(before_px, 1e-3F);
  for (const double step_px : {0.3, 0.6, 1.2}) {
    const cv::Mat parted = ImageOf([&](const Vector2d& u) -> Vector2d {
      return u.x() < static_cast<double>(kCorner.x()) + 4 ? u : Vector2d(u.x() + step_px, u.y() + step_px);
    });
    TemplateMatch match{.centre = kCorner, .affine = Matrix2f::Identity(), .correlation = 0};
    ASSERT_TRUE(patch.Align(parted, &match));
    EXPECT_GT(match.deviation_px, 1.2F * before_px) << step_px;
    before_px = match.deviation_px;
  }
  EXPECT_GT(before_px, 0.01F);
}

TEST(FeatureTrack, HasABoundedNoiseRatio) {
  FeatureTrack track;
  EXPECT_EQ(track.NoiseRatio(), 1);
  track.match_error_px = 1e6;  // of an edge
  EXPECT_EQ(track.NoiseRatio(), 100);
  track.match_error_px = NAN;
  EXPECT_EQ(track.NoiseRatio(), 100);
}

TEST(PatchTemplate, WhatLooksDifferentSeldomCorrelates) {
  const cv::Mat image = ImageOf(kAsItIs);
  const cv::Mat other = ImageOf([](const Vector2d& u) -> Vector2d { return u + Vector2d(3000, 4000); });
  int alike = 0, same = 0;
  for (int i = 0; i < 64; ++i) {
    const int row = i / 8;
    const Vector2f corner(20.0F + 11 * static_cast<float>(i % 8), 20.0F + 11 * static_cast<float>(row));
    const PatchTemplate patch(image, corner, kSidePx);
    TemplateMatch match{.centre = corner, .affine = Matrix2f::Identity(), .correlation = 0};
    same += patch.Align(image, &match) && match.correlation > 0.99F ? 1 : 0;
    match = {.centre = corner, .affine = Matrix2f::Identity(), .correlation = 0};
    alike += patch.Align(other, &match) && match.correlation > 0.8F ? 1 : 0;
  }
  EXPECT_GE(same, 60);
  EXPECT_LE(alike, 8);
}

TEST(PatchTemplate, FlatPatchesAndPatchesOutOfTheImageAreRefused) {
  const cv::Mat flat(kSizePx, kSizePx, CV_8UC1, cv::Scalar(90));
  TemplateMatch match{.centre = kCorner, .affine = Matrix2f::Identity(), .correlation = 0};
  EXPECT_TRUE(PatchTemplate(flat, kCorner, kSidePx).empty());
  EXPECT_FALSE(PatchTemplate(flat, kCorner, kSidePx).Align(flat, &match));
  const cv::Mat image = ImageOf(kAsItIs);
  const PatchTemplate patch(image, kCorner, kSidePx);
  EXPECT_FALSE(patch.Align(flat, &match));
  match.centre = {3, 60};
  EXPECT_FALSE(patch.Align(image, &match));
  EXPECT_FALSE(PatchTemplate::Fits(image, {5, 60}, kSidePx));
  EXPECT_TRUE(PatchTemplate::Fits(image, {20, 60}, kSidePx));
}

TEST(PatchTemplate, WearsOutWhenItGrowsShrinksOrLeansTooFar) {
  EXPECT_FALSE(PatchTemplate::IsWornOut(Matrix2f::Identity()));
  EXPECT_FALSE(PatchTemplate::IsWornOut(Eigen::Rotation2Df(2.0F).toRotationMatrix()));
  EXPECT_TRUE(PatchTemplate::IsWornOut(1.6F * Matrix2f::Identity()));
  EXPECT_TRUE(PatchTemplate::IsWornOut(0.6F * Matrix2f::Identity()));
  Matrix2f lean = Matrix2f::Identity();
  lean(0, 1) = 1.2F;
  EXPECT_TRUE(PatchTemplate::IsWornOut(lean));
}

}  // namespace
}  // namespace alidade
