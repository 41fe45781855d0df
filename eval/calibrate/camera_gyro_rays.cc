#include "eval/calibrate/camera_gyro_rays.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/calibration.h"
#include "core/visual_observation.h"
#include "frontend/initialization/dynamic_window.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Tangent = Eigen::Matrix<double, 3, 2>;

bool RayOf(const CameraModel& camera, const Vector2d& pixel, RowRay* ray) {
  NormalizedObservation observation;
  if (!NormalizeObservation(camera, pixel, 1.0, &observation)) {
    return false;
  }
  ray->direction = BearingOf(observation);
  ray->sigma = AngularDeviation(observation);
  ray->pixel_row = pixel.y() / camera.height_px() - 0.5;
  return true;
}

/// Rows over a plane's coordinates by fu, fv, centre and coefficients, to those over a ray, `to_ray`, by the
/// coordinates of the fit.
LensRows RowsOfLens(const CameraModel& camera, const Tangent& to_ray,
                    const Eigen::Matrix<double, 2, 8>& plane_rows) {
  LensRows rows = LensRows::Zero();
  const Eigen::Vector4d& k = camera.intrinsics();
  const Vector2d by_fu = plane_rows.col(0) * k[0];
  const Vector2d by_fv = plane_rows.col(1) * k[1];
  rows.col(0) = to_ray * (by_fu + by_fv);
  rows.col(1) = to_ray * (by_fu - by_fv) / 2;
  rows.middleCols<2>(2) = to_ray * plane_rows.middleCols<2>(2);
  const int coefficients = std::min(CoefficientCount(camera.model()), 4);
  rows.middleCols(4, coefficients) = to_ray * plane_rows.middleCols(4, coefficients);
  return rows;
}

/// IntrinsicsOfRay by the tangent plane, wherever the ray points.
LensRows IntrinsicsOfSphericalRay(const CameraModel& camera, const Vector3d& direction) {
  Eigen::Matrix<double, 2, 8> pixel_rows;
  NormalizedObservation at;
  at.plane = BearingPlane::TangentAt(direction);
  Eigen::Matrix2d pixel_from_plane;
  if (!IntrinsicsJacobian(camera, direction, &pixel_rows) || !PixelJacobian(camera, at, &pixel_from_plane)) {
    return LensRows::Zero();
  }
  return RowsOfLens(camera, at.plane.axes().leftCols<2>(), -pixel_from_plane.inverse() * pixel_rows);
}

/// A ray seen by its row's camera, in the axes of the middle row's.
Vector3d TurnToMiddleRow(const RowRay& ray, const FrameMotion& frame, const CameraGyroModel& model,
                         const GyroPath& path) {
  if (model.readout_s == 0) {
    return ray.direction;
  }
  const Matrix3d R_0row = path.At(frame.t_s + model.readout_s * ray.pixel_row).R_0t;
  return model.R_BC.transpose() * (frame.R_0B.transpose() * (R_0row * (model.R_BC * ray.direction)));
}

}  // namespace

LensRows IntrinsicsOfRay(const CameraModel& camera, const Vector3d& direction) {
  if (camera.is_spherical()) {
    return IntrinsicsOfSphericalRay(camera, direction);
  }
  LensRows rows = LensRows::Zero();
  const Vector2d z = direction.head<2>() / direction.z();
  Eigen::Matrix<double, 2, 8> pixel_rows;
  Vector2d pixel;
  Eigen::Matrix<double, 2, 3> projection;
  if (!IntrinsicsJacobian(camera, z, &pixel_rows) ||
      !camera.Project(Vector3d(z.x(), z.y(), 1), &pixel, &projection)) {
    return rows;
  }
  const Eigen::Matrix<double, 2, 8> plane_rows = -projection.leftCols<2>().inverse() * pixel_rows;
  Eigen::Matrix<double, 3, 2> to_ray;
  const double length = std::hypot(1.0, z.norm());
  to_ray << Eigen::Matrix2d::Identity(), 0, 0;
  to_ray = (to_ray - direction * direction.head<2>().transpose()).eval() / length;
  return RowsOfLens(camera, to_ray, plane_rows);
}

PairMotion MotionOf(const FramePair& pair, const CameraGyroModel& model, const GyroPath& path) {
  PairMotion motion;
  motion.i.t_s = pair.t_i_s + model.time_offset_s;
  motion.j.t_s = pair.t_j_s + model.time_offset_s;
  const GyroPath::Point i = path.At(motion.i.t_s);
  const GyroPath::Point j = path.At(motion.j.t_s);
  const Matrix3d R_CB = model.R_BC.transpose();
  motion.i.R_0B = i.R_0t;
  motion.j.R_0B = j.R_0t;
  motion.i.rate_C = R_CB * i.rate_B;
  motion.j.rate_C = R_CB * j.rate_B;
  motion.R_ij = R_CB * i.R_0t.transpose() * j.R_0t * model.R_BC;
  motion.bias_j = R_CB * GyroPath::BiasJacobian(i, j);
  return motion;
}

ViewRays RaysOf(const PairView& view, const CameraGyroModel& model, const PairMotion& motion,
                const GyroPath& path, double noise_px) {
  ViewRays rays;
  if (!RayOf(model.camera, view.pixel_i, &rays.i) || !RayOf(model.camera, view.pixel_j, &rays.j)) {
    return rays;
  }
  rays.seen = true;
  rays.epipolar.ray_i = TurnToMiddleRow(rays.i, motion.i, model, path);
  rays.epipolar.ray_j = motion.R_ij * TurnToMiddleRow(rays.j, motion.j, model, path);
  rays.epipolar.normal = rays.epipolar.ray_i.cross(rays.epipolar.ray_j);
  rays.epipolar.sigma = noise_px * std::hypot(rays.i.sigma, rays.j.sigma);
  return rays;
}

}  // namespace alidade
