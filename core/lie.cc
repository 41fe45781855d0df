#include "core/lie.h"

#include <Eigen/SVD>
#include <array>
#include <cmath>

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Below this angle the closed forms of Gamma_2 and Gamma_3 cancel; ten Taylor terms are exact to 1e-16 there.
constexpr double kSeriesAngle = 0.3;

// Vectors whose cosine is nearer than this to -1 have no direction of their cross product.
constexpr double kOpposite = 1e-12;

/// a(theta) and b(theta) of Gamma_m = I/m! + a [phi]x + b [phi]x^2, m in 0..4.
std::array<double, 2> GammaCoefficients(double theta, int m) {
  if (theta < kSeriesAngle) {
    // a = sum_j (-1)^j theta^2j / (2j + 1 + m)!,  b = sum_j (-1)^j theta^2j / (2j + 2 + m)!
    double a_term = 1.0 / std::tgamma(m + 2.0);
    double b_term = 1.0 / std::tgamma(m + 3.0);
    double a = 0;
    double b = 0;
    for (int j = 0; j < 10; ++j) {
      a += a_term;
      b += b_term;
      a_term *= -theta * theta / ((2 * j + 2 + m) * (2 * j + 3 + m));
      b_term *= -theta * theta / ((2 * j + 3 + m) * (2 * j + 4 + m));
    }
    return {a, b};
  }
  const double s = std::sin(theta);
  const double c = std::cos(theta);
  const double t2 = theta * theta;
  switch (m) {
    case 0:
      return {s / theta, (1 - c) / t2};
    case 1:
      return {(1 - c) / t2, (theta - s) / (t2 * theta)};
    case 2:
      return {(theta - s) / (t2 * theta), (t2 / 2 - 1 + c) / (t2 * t2)};
    case 3:
      return {(t2 / 2 - 1 + c) / (t2 * t2), (t2 * theta / 6 - theta + s) / (t2 * t2 * theta)};
    default:
      return {(t2 * theta / 6 - theta + s) / (t2 * t2 * theta),
              (t2 * t2 / 24 - t2 / 2 + 1 - c) / (t2 * t2 * t2)};
  }
}

/// Coefficient of [phi]x^2 in the inverse of J_l: (1 - theta/2 cot(theta/2)) / theta^2.
double InverseJacobianCoefficient(double theta) {
  const double t2 = theta * theta;
  if (theta < 1e-2) {
    return 1.0 / 12 + t2 / 720 + t2 * t2 / 30240;
  }
  return (1 - 0.5 * theta / std::tan(0.5 * theta)) / t2;
}

}  // namespace

namespace so3 {

Matrix3d Gamma(const Vector3d& phi, int m) {
  const std::array<double, 2> ab = GammaCoefficients(phi.norm(), m);
  const Matrix3d p = Skew(phi);
  return Matrix3d::Identity() / std::tgamma(m + 1.0) + ab[0] * p + ab[1] * (p * p);
}

Matrix3d GammaDerivative(const Vector3d& phi, const Vector3d& v, int m) {
  // With c_k = sum_j (-1)^j theta^2j / (2j + k)!, a = c_m+1, b = c_m+2 and c_k' / theta = k c_k+2 - c_k+1.
  const double theta = phi.norm();
  const std::array<double, 2> ab = GammaCoefficients(theta, m);
  const std::array<double, 2> next = GammaCoefficients(theta, m + 2);
  const double a_slope = (m + 1) * next[0] - ab[1];
  const double b_slope = (m + 2) * next[1] - next[0];
  const Vector3d phi_v = phi.cross(v);
  Matrix3d derivative = -ab[0] * Skew(v) - ab[1] * (Skew(phi_v) + Skew(phi) * Skew(v));
  derivative += (a_slope * phi_v + b_slope * phi.cross(phi_v)) * phi.transpose();
  return derivative;
}

Matrix3d Exp(const Vector3d& phi) {
  return Gamma(phi, 0);
}

Vector3d Log(const Matrix3d& rotation) {
  // Through the quaternion: well conditioned for every angle, unlike the trace formula near 0 and pi.
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) {
    q.coeffs() = -q.coeffs();
  }
  const double n = q.vec().norm();
  if (n < 1e-10) {
    return 2.0 / q.w() * q.vec();
  }
  return 2.0 * std::atan2(n, q.w()) / n * q.vec();
}

Matrix3d LeftJacobian(const Vector3d& phi) {
  return Gamma(phi, 1);
}

Matrix3d RightJacobian(const Vector3d& phi) {
  return Gamma(-phi, 1);
}

Matrix3d LeftJacobianInverse(const Vector3d& phi) {
  const Matrix3d p = Skew(phi);
  return Matrix3d::Identity() - 0.5 * p + InverseJacobianCoefficient(phi.norm()) * (p * p);
}

Matrix3d RightJacobianInverse(const Vector3d& phi) {
  return LeftJacobianInverse(-phi);
}

Matrix3d Normalize(const Matrix3d& m) {
  const Eigen::JacobiSVD<Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) {
    u.col(2) = -u.col(2);
  }
  return u * svd.matrixV().transpose();
}

double NearestYaw(const Matrix3d& m) {
  // trace(Rz(yaw)^T m) = (m00 + m11) cos(yaw) + (m10 - m01) sin(yaw) + m22 is largest.
  return std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1));
}

Matrix3d Between(const Vector3d& from, const Vector3d& to) {
  const Vector3d a = from.normalized();
  const Vector3d b = to.normalized();
  const double c = b.dot(a);
  // Not Eigen's FromTwoVectors: it turns opposite vectors through an SVD that takes the compiler 9 s.
  if (c < -1 + kOpposite) {
    const Vector3d axis = a.unitOrthogonal();
    return Eigen::Quaterniond(0, axis.x(), axis.y(), axis.z()).toRotationMatrix();
  }
  const double s = std::sqrt((1 + c) * 2);
  const Vector3d axis = a.cross(b) * (1 / s);
  return Eigen::Quaterniond(s * 0.5, axis.x(), axis.y(), axis.z()).toRotationMatrix();
}

}  // namespace so3
}  // namespace alidade
