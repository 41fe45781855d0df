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

/// Off-diagonal block Q(phi, rho) of the SE(3) left Jacobian, Barfoot, "State estimation for robotics",
/// eq. 7.86.
Matrix3d BarfootQ(const Vector3d& phi, const Vector3d& rho) {
  const double theta = phi.norm();
  const double t2 = theta * theta;
  double c1;
  double c2;
  double c3;
  if (theta < 0.3) {
    const double t4 = t2 * t2;
    c1 = 1.0 / 6 - t2 / 120 + t4 / 5040 - t4 * t2 / 362880;
    c2 = 1.0 / 24 - t2 / 720 + t4 / 40320 - t4 * t2 / 3628800;
    const double d = 1.0 / 120 - t2 / 5040 + t4 / 362880 - t4 * t2 / 39916800;
    c3 = 0.5 * (c2 - 3 * d);
  } else {
    const double s = std::sin(theta);
    const double c = std::cos(theta);
    c1 = (theta - s) / (t2 * theta);
    c2 = (t2 / 2 + c - 1) / (t2 * t2);
    const double d = (theta - s - t2 * theta / 6) / (t2 * t2 * theta);
    c3 = 0.5 * (c2 + 3 * d);
  }
  const Matrix3d p = Skew(phi);
  const Matrix3d r = Skew(rho);
  return 0.5 * r + c1 * (p * r + r * p + p * r * p) + c2 * (p * p * r + r * p * p - 3 * p * r * p) +
         c3 * (p * r * p * p + p * p * r * p);
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

Eigen::Quaterniond ExpQuaternion(const Vector3d& phi) {
  const double half = 0.5 * phi.norm();
  const double scale = half < 1e-4 ? 0.5 - half * half / 12 : 0.5 * std::sin(half) / half;
  return Eigen::Quaterniond(std::cos(half), scale * phi.x(), scale * phi.y(), scale * phi.z()).normalized();
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

}  // namespace so3

namespace se3 {

Eigen::Matrix4d Exp(const Vector6d& xi) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = so3::Exp(xi.head<3>());
  m.topRightCorner<3, 1>() = so3::LeftJacobian(xi.head<3>()) * xi.tail<3>();
  return m;
}

Vector6d Log(const Eigen::Matrix4d& transform) {
  Vector6d xi;
  xi.head<3>() = so3::Log(transform.topLeftCorner<3, 3>());
  xi.tail<3>() = so3::LeftJacobianInverse(xi.head<3>()) * transform.topRightCorner<3, 1>();
  return xi;
}

Matrix6d LeftJacobian(const Vector6d& xi) {
  Matrix6d j = Matrix6d::Zero();
  j.topLeftCorner<3, 3>() = so3::LeftJacobian(xi.head<3>());
  j.bottomRightCorner<3, 3>() = j.topLeftCorner<3, 3>();
  j.bottomLeftCorner<3, 3>() = BarfootQ(xi.head<3>(), xi.tail<3>());
  return j;
}

Matrix6d RightJacobian(const Vector6d& xi) {
  return LeftJacobian(-xi);
}

Matrix6d Adjoint(const Eigen::Matrix4d& transform) {
  const Matrix3d r = transform.topLeftCorner<3, 3>();
  Matrix6d a = Matrix6d::Zero();
  a.topLeftCorner<3, 3>() = r;
  a.bottomRightCorner<3, 3>() = r;
  a.bottomLeftCorner<3, 3>() = Skew(transform.topRightCorner<3, 1>()) * r;
  return a;
}

}  // namespace se3

namespace se23 {

Matrix5d Exp(const Vector9d& xi) {
  Matrix5d m = Matrix5d::Identity();
  const Matrix3d j = so3::LeftJacobian(xi.head<3>());
  m.topLeftCorner<3, 3>() = so3::Exp(xi.head<3>());
  m.block<3, 1>(0, 3) = j * xi.segment<3>(3);
  m.block<3, 1>(0, 4) = j * xi.tail<3>();
  return m;
}

Vector9d Log(const Matrix5d& element) {
  Vector9d xi;
  xi.head<3>() = so3::Log(element.topLeftCorner<3, 3>());
  const Matrix3d j_inverse = so3::LeftJacobianInverse(xi.head<3>());
  xi.segment<3>(3) = j_inverse * element.block<3, 1>(0, 3);
  xi.tail<3>() = j_inverse * element.block<3, 1>(0, 4);
  return xi;
}

Matrix9d LeftJacobian(const Vector9d& xi) {
  Matrix9d j = Matrix9d::Zero();
  const Matrix3d j_rotation = so3::LeftJacobian(xi.head<3>());
  for (int i = 0; i < 3; ++i) {
    j.block<3, 3>(3 * i, 3 * i) = j_rotation;
  }
  j.block<3, 3>(3, 0) = BarfootQ(xi.head<3>(), xi.segment<3>(3));
  j.block<3, 3>(6, 0) = BarfootQ(xi.head<3>(), xi.tail<3>());
  return j;
}

Matrix9d RightJacobian(const Vector9d& xi) {
  return LeftJacobian(-xi);
}

Matrix9d Adjoint(const Matrix5d& element) {
  const Matrix3d r = element.topLeftCorner<3, 3>();
  Matrix9d a = Matrix9d::Zero();
  for (int i = 0; i < 3; ++i) {
    a.block<3, 3>(3 * i, 3 * i) = r;
  }
  a.block<3, 3>(3, 0) = Skew(element.block<3, 1>(0, 3)) * r;
  a.block<3, 3>(6, 0) = Skew(element.block<3, 1>(0, 4)) * r;
  return a;
}

}  // namespace se23
}  // namespace alidade
