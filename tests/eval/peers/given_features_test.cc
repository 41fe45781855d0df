#include "eval/peers/given_features.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(GivenFeatures, TakesTracksSeenBeforeWithTheirVelocity) {
  const CameraModel camera =
      CameraModel::Create(DistortionModel::kNone, Eigen::Vector4d(400, 400, 320, 240), {}, 640, 480).value();
  GivenFeatures given;
  EXPECT_TRUE(
      given.Take(camera, {0, {{7, Eigen::Vector2d(320, 240)}, {8, Eigen::Vector2d(1, 2)}}}, 1).empty());
  const auto features =
      given.Take(camera, {1, {{7, Eigen::Vector2d(360, 240)}, {9, Eigen::Vector2d(3, 4)}}}, 1.5);
  ASSERT_EQ(features.size(), 1u) << "9 is new, 8 is gone";
  EXPECT_EQ(features[0].id, 7);
  EXPECT_EQ(features[0].pixel, Eigen::Vector2d(360, 240));
  EXPECT_LT((features[0].plane - Eigen::Vector2d(0.1, 0)).norm(), 1e-12);
  EXPECT_LT((features[0].velocity - Eigen::Vector2d(0.2, 0)).norm(), 1e-12);
  EXPECT_TRUE(given.Take(camera, {2, {{8, Eigen::Vector2d(1, 2)}}}, 2).empty()) << "not in the frame before";
}

}  // namespace
}  // namespace alidade
