#include <Eigen/Geometry>
#include <cmath>

#include "core/camera_model.h"
#include "core/equidistant_lens.h"

// What a lens does to a point of the normalised plane, and its derivatives.

namespace alidade {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Adds the tangential terms of a lens to a distorted point and, unless null, to its Jacobian.
void AddTangential(const Vector2d& ideal, double p1, double p2, Vector2d* distorted, Matrix2d* jacobian) {
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = x * x + y * y;
  *distorted += Vector2d(2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y);
  if (jacobian != nullptr) {
    Matrix2d tangential;
    tangential << 2 * p1 * y + 6 * p2 * x, 2 * p1 * x + 2 * p2 * y, 2 * p1 * x + 2 * p2 * y,
        6 * p1 * y + 2 * p2 * x;
    *jacobian += tangential;
  }
}

}  // namespace

double CameraModel::RadialDistortion(double radius, double* derivative) const {
  const LensCoefficients& k = coefficients_;
  switch (model_) {
    case DistortionModel::kRadialTangential: {
      const double r2 = radius * radius;
      *derivative = 1 + r2 * (3 * k[0] + 5 * k[1] * r2);
      return radius * (1 + r2 * (k[0] + k[1] * r2));
    }
    case DistortionModel::kEquidistant: {
      double by_angle = 0;
      const double distorted = EquidistantRadius(std::atan(radius), k.head<4>(), &by_angle);
      *derivative = by_angle / (1 + radius * radius);
      return distorted;
    }
    case DistortionModel::kFov: {
      const double a = 2 * std::tan(0.5 * k[0]);
      *derivative = a / (k[0] * (1 + a * a * radius * radius));
      return std::atan(a * radius) / k[0];
    }
    case DistortionModel::kMei: {
      // m = r / (1 + xi n) with n = sqrt(1 + r^2), so dm/dr = (1 + xi / n) / (1 + xi n)^2
      const double n = std::sqrt(1 + radius * radius);
      const double scale = 1 / (1 + k[0] * n);
      const double m = radius * scale;
      const double m2 = m * m;
      *derivative = (1 + m2 * (3 * k[1] + 5 * k[2] * m2)) * scale * scale * (1 + k[0] / n);
      return m * (1 + m2 * (k[1] + k[2] * m2));
    }
    case DistortionModel::kDoubleSphere:
    case DistortionModel::kEucm:  // RadialOfAngle
    case DistortionModel::kNone:
      break;
  }
  *derivative = 1;
  return radius;
}

void CameraModel::DistortMei(const Vector2d& ideal, Vector2d* distorted, Matrix2d* jacobian) const {
  const double xi = coefficients_[0], k1 = coefficients_[1], k2 = coefficients_[2];
  const double n = std::sqrt(1 + ideal.squaredNorm());
  const double shrink = 1 / (1 + xi * n);
  const Vector2d m = shrink * ideal;
  const double m2 = m.squaredNorm();
  const double scale = 1 + m2 * (k1 + k2 * m2);
  *distorted = scale * m;
  if (jacobian != nullptr) {
    *jacobian = scale * Matrix2d::Identity() + 2 * (k1 + 2 * k2 * m2) * (m * m.transpose());
  }
  AddTangential(m, coefficients_[3], coefficients_[4], distorted, jacobian);
  if (jacobian != nullptr) {
    // d (shrink x) / d x = shrink I - xi shrink^2 / n x x^T
    const Matrix2d mirror =
        shrink * Matrix2d::Identity() - (xi * shrink * shrink / n) * (ideal * ideal.transpose());
    *jacobian = *jacobian * mirror;
  }
}

bool CameraModel::Distort(const Vector2d& ideal, Vector2d* distorted, Matrix2d* jacobian) const {
  const double x = ideal.x();
  const double y = ideal.y();
  const double r2 = x * x + y * y;
  if (!(r2 <= max_radius_ * max_radius_)) {
    return false;
  }
  if (model_ == DistortionModel::kNone) {
    *distorted = ideal;
    if (jacobian != nullptr) {
      jacobian->setIdentity();
    }
    return true;
  }
  if (model_ == DistortionModel::kMei) {
    DistortMei(ideal, distorted, jacobian);
    return true;
  }
  if (spherical_) {
    Eigen::Matrix<double, 2, 3> over_point;
    if (!DistortRay(ideal.homogeneous(), distorted, jacobian != nullptr ? &over_point : nullptr)) {
      return false;
    }
    if (jacobian != nullptr) {
      *jacobian = over_point.leftCols<2>();
    }
    return true;
  }
  const double r = std::sqrt(r2);
  double derivative = 0;
  const double r_d = RadialDistortion(r, &derivative);
  double scale = 0;
  if (r > 1e-9) {
    scale = r_d / r;
  } else {
    RadialDistortion(0, &scale);
  }
  *distorted = scale * ideal;
  if (jacobian != nullptr) {
    // d (scale(r) x) / d x = scale I + (r_d' - scale) x x^T / r^2
    const double radial = r2 > 1e-18 ? (derivative - scale) / r2 : 0.0;
    *jacobian << scale + radial * x * x, radial * x * y, radial * x * y, scale + radial * y * y;
  }
  if (model_ == DistortionModel::kRadialTangential) {
    AddTangential(ideal, coefficients_[2], coefficients_[3], distorted, jacobian);
  }
  return true;
}

}  // namespace alidade
