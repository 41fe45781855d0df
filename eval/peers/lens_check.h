#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "core/camera_model.h"
#include "core/status.h"

namespace alidade {

/// Whether another system undistorts pixels to the rays that our camera model gives, over the whole image to
/// half a pixel: a compiler has got one wrong by tens of pixels. `ray`: pixel to a ray with z > 0. kInput: it
/// differs.
Status CheckLens(const CameraModel& camera,
                 const std::function<Eigen::Vector3d(const Eigen::Vector2d& pixel)>& ray);

}  // namespace alidade
