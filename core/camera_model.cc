#include "core/camera_model.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/reprojection.h"

namespace alidade {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// A point closer to the image plane than this is not a landmark any camera here resolves; it also keeps 1/z
// bounded.
constexpr double kMinDepthM = 1e-3;
// tan(89.9 deg): the normalised plane itself ends at 90 degrees off axis.
constexpr double kMaxRadius = 572.0;

}  // namespace

Result<CameraModel> CameraModel::Create(DistortionModel model, const Vector4d& fu_fv_cu_cv,
                                        const std::vector<double>& coefficients, int width_px,
                                        int height_px) {
  if (!fu_fv_cu_cv.allFinite() || fu_fv_cu_cv[0] <= 0 || fu_fv_cu_cv[1] <= 0) {
    return Status::Input("intrinsics: expected finite fu, fv, cu, cv with positive focal lengths [px]");
  }
  if (width_px <= 0 || height_px <= 0) {
    return Status::Input("resolution: expected positive width and height [px], found " +
                         std::to_string(width_px) + " x " + std::to_string(height_px));
  }
  ALIDADE_RETURN_IF_ERROR(CheckCoefficients(model, coefficients));
  CameraModel camera;
  camera.model_ = model;
  camera.intrinsics_ = fu_fv_cu_cv;
  camera.width_px_ = width_px;
  camera.height_px_ = height_px;
  for (size_t i = 0; i < coefficients.size(); ++i) {
    camera.coefficients_[static_cast<Eigen::Index>(i)] = coefficients[i];
  }
  camera.BoundDomain();
  return camera;
}

void CameraModel::BoundDomain() {
  // A calibration does not hold far outside the image it was made with.
  constexpr double kMarginBeyondCorner = 1.5;
  double corner = 0;
  for (const double u : {0.0, static_cast<double>(width_px_)}) {
    for (const double v : {0.0, static_cast<double>(height_px_)}) {
      const Vector2d distorted =
          (Vector2d(u, v) - intrinsics_.tail<2>()).cwiseQuotient(intrinsics_.head<2>());
      corner = std::max(corner, distorted.norm());
    }
  }
  if (model_ == DistortionModel::kDoubleSphere || model_ == DistortionModel::kEucm) {
    BoundSphere(kMarginBeyondCorner * corner, corner);
    spherical_ = true;
    max_radius_ = std::tan(std::min(max_angle_, std::atan(kMaxRadius)));
  } else {
    BoundPlane(kMarginBeyondCorner * corner, corner);
    if (model_ == DistortionModel::kEquidistant && field_angle_ > kMaxPlaneAngle) {
      BoundSphere(kMarginBeyondCorner * corner, corner);
      spherical_ = true;
    }
  }
  plane_ = spherical_ && field_angle_ > kMaxPlaneAngle ? ObservationPlane::kTangent
                                                       : ObservationPlane::kNormalized;
}

void CameraModel::BoundPlane(double farthest, double corner) {
  // March outwards in angle until the radial map stops growing; the tangential terms are too small to move
  // the bound.
  constexpr int kSteps = 2000;
  const double max_angle = std::atan(kMaxRadius);
  max_radius_ = 0;
  field_angle_ = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double radius = std::tan(max_angle * i / kSteps);
    double derivative = 0;
    const double distorted = RadialDistortion(radius, &derivative);
    if (derivative <= 1e-6 / (1 + radius * radius) || distorted > farthest) {
      break;
    }
    max_radius_ = radius;
    field_angle_ = distorted <= corner ? max_angle * i / kSteps : field_angle_;
  }
  double unused = 0;
  max_distorted_radius_ = RadialDistortion(max_radius_, &unused);
  max_angle_ = std::atan(max_radius_);
}

bool CameraModel::Project(const Vector3d& p_C, Vector2d* pixel, Eigen::Matrix<double, 2, 3>* jacobian) const {
  if (spherical_) {
    Vector2d distorted;
    if (!(p_C.squaredNorm() > kMinDepthM * kMinDepthM) || !DistortRay(p_C, &distorted, jacobian)) {
      return false;
    }
    *pixel = intrinsics_.head<2>().cwiseProduct(distorted) + intrinsics_.tail<2>();
    if (jacobian != nullptr) {
      *jacobian = intrinsics_.head<2>().asDiagonal() * *jacobian;
    }
    return true;
  }
  if (!(p_C.z() > kMinDepthM)) {
    return false;
  }
  const Vector2d ideal = p_C.head<2>() * (1.0 / p_C.z());
  Vector2d distorted;
  Matrix2d distortion_jacobian;
  if (!Distort(ideal, &distorted, jacobian != nullptr ? &distortion_jacobian : nullptr)) {
    return false;
  }
  *pixel = intrinsics_.head<2>().cwiseProduct(distorted) + intrinsics_.tail<2>();
  if (jacobian != nullptr) {
    *jacobian = intrinsics_.head<2>().asDiagonal() * distortion_jacobian * ProjectionJacobian(ideal, p_C.z());
  }
  return true;
}

bool CameraModel::Undistort(const Vector2d& distorted, Vector2d* ideal) const {
  const double r_d = distorted.norm();
  if (!(r_d <= max_distorted_radius_)) {
    return false;
  }
  // Newton on the radius alone, bisecting when it leaves the bracket: converges for every one-to-one radial
  // map.
  double low = 0;
  double high = max_radius_;
  double radius = std::min(r_d, max_radius_);
  for (int i = 0; i < 60; ++i) {
    double derivative = 0;
    const double error = RadialDistortion(radius, &derivative) - r_d;
    if (std::abs(error) < 1e-14) {
      break;
    }
    (error > 0 ? high : low) = radius;
    const double newton = radius - error / derivative;
    radius = (newton > low && newton < high) ? newton : 0.5 * (low + high);
  }
  Vector2d x = r_d > 1e-12 ? Vector2d(distorted * (radius / r_d)) : Vector2d::Zero();
  if (r_d <= 1e-12) {
    double scale = 0;
    RadialDistortion(0, &scale);
    x = distorted / scale;
  }
  if (model_ != DistortionModel::kRadialTangential && model_ != DistortionModel::kMei) {
    *ideal = x;
    return true;
  }
  for (int i = 0; i < 20; ++i) {  // Newton with the tangential terms
    Vector2d predicted;
    Matrix2d jacobian;
    if (!Distort(x, &predicted, &jacobian)) {
      return false;
    }
    const Vector2d error = predicted - distorted;
    if (error.squaredNorm() < 1e-28) {
      break;
    }
    x -= jacobian.inverse() * error;
  }
  Vector2d check;
  if (!Distort(x, &check) || (check - distorted).squaredNorm() > 1e-20) {
    return false;
  }
  *ideal = x;
  return true;
}

bool CameraModel::Bearing(const Vector2d& pixel, Vector3d* ray) const {
  if (spherical_) {
    return pixel.allFinite() &&
           UndistortToSphere((pixel - intrinsics_.tail<2>()).cwiseQuotient(intrinsics_.head<2>()), ray);
  }
  Vector2d ideal;
  if (!Unproject(pixel, &ideal)) {
    return false;
  }
  *ray = ideal.homogeneous().normalized();
  return true;
}

bool CameraModel::Unproject(const Vector2d& pixel, Vector2d* normalized, Matrix2d* pixel_jacobian) const {
  if (!pixel.allFinite()) {
    return false;
  }
  const Vector2d distorted = (pixel - intrinsics_.tail<2>()).cwiseQuotient(intrinsics_.head<2>());
  Vector2d ideal;
  if (model_ == DistortionModel::kNone) {
    ideal = distorted;
    if (!(ideal.norm() <= max_radius_)) {
      return false;
    }
  } else if (spherical_) {
    Vector3d ray;
    if (!UndistortToSphere(distorted, &ray) || !(ray.head<2>().norm() <= max_radius_ * ray.z())) {
      return false;
    }
    ideal = ray.head<2>() / ray.z();
  } else if (!Undistort(distorted, &ideal)) {
    return false;
  }
  if (pixel_jacobian != nullptr) {
    Vector2d unused;
    Matrix2d jacobian;
    if (!Distort(ideal, &unused, &jacobian)) {
      return false;
    }
    *pixel_jacobian = intrinsics_.head<2>().asDiagonal() * jacobian;
  }
  *normalized = ideal;
  return true;
}

}  // namespace alidade
