#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/camera_model.h"
#include "core/equidistant_lens.h"

// Spherical lenses: equidistant, double-sphere and eucm over directions of the whole sphere. All three turn
// about their axis, so that each is a distorted radius over the angle off axis, taken by its sine and cosine.

namespace alidade {
namespace {

using Eigen::RowVector4d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// D of double-sphere and eucm, whose distorted radius is s / D at sine s and cosine c, and its derivatives.
struct Denominator {
  double value = 0;
  double by_angle = 0;
  Vector2d by_coefficients = Vector2d::Zero();
};

/// D = alpha d2 + (1 - alpha) k, k = xi + c, d2 = sqrt(s^2 + k^2).
Denominator DoubleSphere(double s, double c, double xi, double alpha) {
  const double k = xi + c;
  const double d2 = std::sqrt(s * s + k * k);
  Denominator denominator;
  denominator.value = alpha * d2 + (1 - alpha) * k;
  // d2 d d2 = -xi s dt: the sines and cosines of the angle itself cancel.
  denominator.by_angle = -s * (alpha * xi / d2 + 1 - alpha);
  denominator.by_coefficients << alpha * k / d2 + 1 - alpha, d2 - k;
  return denominator;
}

/// D = alpha d + (1 - alpha) c, d = sqrt(beta s^2 + c^2).
Denominator Eucm(double s, double c, double alpha, double beta) {
  const double d = std::sqrt(beta * s * s + c * c);
  Denominator denominator;
  denominator.value = alpha * d + (1 - alpha) * c;
  denominator.by_angle = alpha * (beta - 1) * s * c / d - (1 - alpha) * s;
  denominator.by_coefficients << d - c, 0.5 * alpha * s * s / d;
  return denominator;
}

/// z of (m_x, m_y, z) on the ray of double-sphere's second sphere, or of eucm's surface, at s2 = |m|^2; false
/// beyond the last one.
bool SurfaceDepth(double alpha, double beta, double s2, double* z) {
  const double under_root = 1 - (2 * alpha - 1) * beta * s2;
  if (!(under_root >= 0)) {
    return false;
  }
  *z = (1 - beta * alpha * alpha * s2) / (alpha * std::sqrt(under_root) + 1 - alpha);
  return true;
}

}  // namespace

double CameraModel::RadialOfAngle(const Angle& angle, double* derivative,
                                  RowVector4d* by_coefficients) const {
  const LensCoefficients& k = coefficients_;
  const double s = angle.sine;
  const double c = angle.cosine;
  if (model_ == DistortionModel::kEquidistant) {
    return EquidistantRadius(std::atan2(s, c), k.head<4>(), derivative, by_coefficients);
  }
  const Denominator denominator =
      model_ == DistortionModel::kEucm ? Eucm(s, c, k[0], k[1]) : DoubleSphere(s, c, k[0], k[1]);
  if (!(denominator.value > 0)) {
    *derivative = -1;
    return 0;
  }
  const double scale = 1 / denominator.value;
  *derivative = scale * (c - s * scale * denominator.by_angle);
  if (by_coefficients != nullptr) {
    *by_coefficients << -s * scale * scale * denominator.by_coefficients.transpose(), 0, 0;
  }
  return s * scale;
}

void CameraModel::BoundSphere(double farthest, double corner) {
  constexpr int kSteps = 2000;
  max_angle_ = 0;
  field_angle_ = 0;
  max_distorted_radius_ = 0;
  // Not up to 180 degrees: there all directions around the axis are one.
  for (int i = 1; i < kSteps; ++i) {
    const double angle = std::numbers::pi * i / kSteps;
    double derivative = 0;
    const double distorted = RadialOfAngle({std::sin(angle), std::cos(angle)}, &derivative);
    if (!(derivative > 1e-6) || distorted > farthest) {
      break;
    }
    max_angle_ = angle;
    max_distorted_radius_ = distorted;
    field_angle_ = distorted <= corner ? angle : field_angle_;
  }
}

bool CameraModel::DistortRay(const Vector3d& p, Vector2d* distorted, Eigen::Matrix<double, 2, 3>* jacobian,
                             Eigen::Matrix<double, 2, 4>* by_coefficients) const {
  const double beside = p.head<2>().norm();
  const double length = p.norm();
  if (!(length > 0) || !(std::atan2(beside, p.z()) <= max_angle_)) {
    return false;
  }
  double derivative = 0;
  RowVector4d radial_by_coefficients;
  const double radius = RadialOfAngle({beside / length, p.z() / length}, &derivative,
                                      by_coefficients != nullptr ? &radial_by_coefficients : nullptr);
  const bool on_axis = !(beside > 1e-12 * length);
  const double scale = on_axis ? derivative / length : radius / beside;
  const Vector2d outwards = on_axis ? Vector2d::Zero() : Vector2d(p.head<2>() / beside);
  *distorted = scale * p.head<2>();
  if (jacobian != nullptr) {
    // Along and across the radius, and along the axis; the angle moves by (z, -beside) / length^2.
    const double along = derivative * p.z() / (length * length);
    jacobian->leftCols<2>() =
        scale * Eigen::Matrix2d::Identity() + (along - scale) * outwards * outwards.transpose();
    jacobian->col(2) = -derivative / (length * length) * p.head<2>();
  }
  if (by_coefficients != nullptr) {
    *by_coefficients = outwards * radial_by_coefficients;
  }
  return true;
}

double CameraModel::AngleOfRadius(double radius) const {
  // Newton, bisecting when it leaves the bracket: converges for every map that grows up to max_angle_.
  double low = 0;
  double high = max_angle_;
  double angle = std::min(radius, max_angle_);
  for (int i = 0; i < 60; ++i) {
    double derivative = 0;
    const double error = RadialOfAngle({std::sin(angle), std::cos(angle)}, &derivative) - radius;
    if (std::abs(error) < 1e-15) {
      break;
    }
    (error > 0 ? high : low) = angle;
    const double newton = angle - error / derivative;
    angle = newton > low && newton < high ? newton : 0.5 * (low + high);
  }
  return angle;
}

bool CameraModel::UndistortToSphere(const Vector2d& distorted, Vector3d* ray) const {
  const double s2 = distorted.squaredNorm();
  const double radius = std::sqrt(s2);
  if (!(radius <= max_distorted_radius_)) {
    return false;
  }
  if (model_ == DistortionModel::kEquidistant) {
    const double angle = AngleOfRadius(radius);
    const double scale = radius > 1e-12 ? std::sin(angle) / radius : 1.0;
    *ray << scale * distorted, std::cos(angle);
    return true;
  }
  const bool eucm = model_ == DistortionModel::kEucm;
  const double xi = eucm ? 0 : coefficients_[0];
  double z = 0;
  if (!SurfaceDepth(coefficients_[eucm ? 0 : 1], eucm ? coefficients_[1] : 1, s2, &z)) {
    return false;
  }
  if (eucm) {
    *ray = Vector3d(distorted.x(), distorted.y(), z).normalized();
    return true;
  }
  // From the second sphere's centre back to the first one's.
  const double reach = (z * xi + std::sqrt(z * z + (1 - xi * xi) * s2)) / (z * z + s2);
  *ray << reach * distorted, reach * z - xi;
  ray->normalize();
  return true;
}

}  // namespace alidade
