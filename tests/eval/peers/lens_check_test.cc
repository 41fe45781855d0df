#include "eval/peers/lens_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(CheckLens, AcceptsTheSameLensAndRefusesAnother) {
  const CameraModel camera =
      CameraModel::Create(DistortionModel::kRadialTangential, Eigen::Vector4d(460, 460, 376, 240),
                          {-0.28, 0.07, 0, 0}, 752, 480)
          .value();
  const auto ray = [&](const Eigen::Vector2d& pixel, double scale) {
    Eigen::Vector2d plane = Eigen::Vector2d::Zero();
    camera.Unproject(pixel, &plane);
    return Eigen::Vector3d(2 * scale * plane.homogeneous());
  };
  EXPECT_TRUE(CheckLens(camera, [&](const Eigen::Vector2d& pixel) { return ray(pixel, 1); }).ok());
  EXPECT_THAT(CheckLens(camera,
                        [&](const Eigen::Vector2d& pixel) {
                          return Eigen::Vector3d((pixel - camera.intrinsics().tail<2>()).x() / 460,
                                                 (pixel - camera.intrinsics().tail<2>()).y() / 460, 1);
                        })
                  .message(),
              testing::HasSubstr("differently"));
}

}  // namespace
}  // namespace alidade
