#include "eval/calibrate/camera_gyro_equations.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/robust.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Coordinate = CameraGyroCoordinate;
using Tangent = Eigen::Matrix<double, 3, 2>;
/// Over the model and the two angles of the direction.
using JointMatrix = Eigen::Matrix<double, Coordinate::kCount + 2, Coordinate::kCount + 2>;
using JointVector = Eigen::Matrix<double, Coordinate::kCount + 2, 1>;

Tangent TangentOf(const Vector3d& direction) {
  Tangent tangent;
  tangent.col(0) = direction.unitOrthogonal();
  tangent.col(1) = direction.cross(tangent.col(0));
  return tangent;
}

/// Adds one view's row over model and direction.
void AddView(const ViewRays& rays, const PairMotion& motion, const CameraModel& camera, bool intrinsics_free,
             const Vector3d& t, const Tangent& tangent, JointMatrix* information, JointVector* gradient) {
  const double variance = EpipolarVariance(rays.epipolar, t);
  const double residual = t.dot(rays.epipolar.normal);
  // Both rays moved onto their epipolar plane, each by its share of the noise.
  Vector3d a = rays.epipolar.ray_i;
  Vector3d q = rays.epipolar.ray_j;
  const Vector3d by_a = q.cross(t);
  const Vector3d by_q = t.cross(a);
  const double squared_i = rays.i.sigma * rays.i.sigma, squared_j = rays.j.sigma * rays.j.sigma;
  const double spread = squared_i * by_a.squaredNorm() + squared_j * by_q.squaredNorm();
  if (spread > 1e-4 * (squared_i + squared_j)) {
    a = (a - by_a * (residual * squared_i / spread)).normalized();
    q = (q - by_q * (residual * squared_j / spread)).normalized();
  }
  const Vector3d u = t.cross(a);                   // d residual / d q
  const Vector3d w = motion.R_ij.transpose() * u;  // d residual / d ray j in its own camera
  const Vector3d b = motion.R_ij.transpose() * q;
  const Vector3d by_turn_i = u.cross(q);
  const Vector3d by_turn_j = b.cross(w);
  JointVector row;
  row.setZero();
  row.segment<3>(Coordinate::kGyroBias) = motion.bias_j.transpose() * by_turn_j;
  row.segment<3>(Coordinate::kRotation) = by_turn_i + by_turn_j;
  row[Coordinate::kTimeOffset] = by_turn_i.dot(motion.i.rate_C) + by_turn_j.dot(motion.j.rate_C);
  row[Coordinate::kReadout] =
      rays.i.pixel_row * by_turn_i.dot(motion.i.rate_C) + rays.j.pixel_row * by_turn_j.dot(motion.j.rate_C);
  if (intrinsics_free) {
    row.segment<Coordinate::kCount - Coordinate::kFocal>(Coordinate::kFocal) =
        IntrinsicsOfRay(camera, a).transpose() * q.cross(t) + IntrinsicsOfRay(camera, b).transpose() * w;
  }
  row.tail<2>() = tangent.transpose() * a.cross(q);
  const double weight =
      RobustWeight(RobustKernel::kCauchy, kCameraGyroKernelSigma, residual * residual / variance) / variance;
  *information += weight * row * row.transpose();
  *gradient += weight * residual * row;
}

}  // namespace

CameraGyroEquations EquationsOf(const FramePair& pair, const CameraGyroModel& model, const GyroPath& path,
                                const Vector3d& direction, bool intrinsics_free, double noise_px) {
  const Tangent tangent = TangentOf(direction);
  const PairMotion motion = MotionOf(pair, model, path);
  JointMatrix information;
  JointVector gradient;
  information.setZero();
  gradient.setZero();
  for (const PairView& view : pair.views) {
    if (const ViewRays rays = RaysOf(view, model, motion, path, noise_px); rays.seen) {
      AddView(rays, motion, model.camera, intrinsics_free, direction, tangent, &information, &gradient);
    }
  }
  // Without parallax the direction is loose: the unit prior on its two angles keeps the elimination
  // regular.
  const Eigen::Matrix2d loose =
      (information.bottomRightCorner<2, 2>() + Eigen::Matrix2d::Identity()).inverse();
  CameraGyroEquations equations;
  equations.direction_by_model = loose * information.bottomLeftCorner<2, Coordinate::kCount>();
  equations.direction_step = loose * gradient.tail<2>();
  equations.information = information.topLeftCorner<Coordinate::kCount, Coordinate::kCount>() -
                          information.topRightCorner<Coordinate::kCount, 2>() * equations.direction_by_model;
  equations.gradient = gradient.head<Coordinate::kCount>() -
                       information.topRightCorner<Coordinate::kCount, 2>() * equations.direction_step;
  return equations;
}

Vector3d MovedDirection(const Vector3d& direction, const Eigen::Vector2d& angles) {
  return (direction + TangentOf(direction) * angles).normalized();
}

}  // namespace alidade
