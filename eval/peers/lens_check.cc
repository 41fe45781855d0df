#include "eval/peers/lens_check.h"

#include "core/format.h"

namespace alidade {

Status CheckLens(const CameraModel& camera,
                 const std::function<Eigen::Vector3d(const Eigen::Vector2d& pixel)>& ray) {
  constexpr int kSteps = 10;
  constexpr double kToleratedPx = 0.5;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel(i * (camera.width_px() - 1.0) / kSteps,
                                  j * (camera.height_px() - 1.0) / kSteps);
      Eigen::Vector2d plane;
      if (!camera.Unproject(pixel, &plane)) {
        continue;
      }
      const Eigen::Vector2d other = ray(pixel).hnormalized();
      const double difference_px = camera.intrinsics()[0] * (other - plane).norm();
      if (!(difference_px < kToleratedPx)) {
        return Status::Input(Format("the other system undistorts pixel (%.0f, %.0f) differently, by %.2f px",
                                    pixel.x(), pixel.y(), difference_px));
      }
    }
  }
  return Status::Ok();
}

}  // namespace alidade
