#include "core/error_convention.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d RetractRotation(ErrorConvention convention, const Matrix3d& rotation, const Vector3d& theta) {
  const Matrix3d delta = so3::Exp(theta);
  return convention == ErrorConvention::kRightInvariant ? Matrix3d(delta * rotation)
                                                        : Matrix3d(rotation * delta);
}

/// A vector that the rotation couples to (position or velocity), after the rotation error `theta`.
Vector3d RetractVector(ErrorConvention convention, const Matrix3d& rotation, const Vector3d& x,
                       const Vector3d& theta, const Vector3d& xi) {
  switch (convention) {
    case ErrorConvention::kRightInvariant:
      return so3::Exp(theta) * x + xi;
    case ErrorConvention::kLeftInvariant:
      return x + rotation * xi;
    case ErrorConvention::kSo3xRn:
      break;
  }
  return x + xi;
}

Vector3d LocalRotation(ErrorConvention convention, const Matrix3d& estimate, const Matrix3d& truth) {
  return convention == ErrorConvention::kRightInvariant ? so3::Log(truth * estimate.transpose())
                                                        : so3::Log(estimate.transpose() * truth);
}

Vector3d LocalVector(ErrorConvention convention, const Matrix3d& estimate, const Matrix3d& truth,
                     const Vector3d& x, const Vector3d& x_truth) {
  switch (convention) {
    case ErrorConvention::kRightInvariant:
      return x_truth - truth * (estimate.transpose() * x);
    case ErrorConvention::kLeftInvariant:
      return estimate.transpose() * (x_truth - x);
    case ErrorConvention::kSo3xRn:
      break;
  }
  return x_truth - x;
}

/// Fills C (or its inverse) for one rotation and `count` coupled vectors.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> Chart(ErrorConvention convention, const Matrix3d& rotation,
                                          const Vector3d* vectors, bool inverse) {
  Eigen::Matrix<double, kSize, kSize> c = Eigen::Matrix<double, kSize, kSize>::Identity();
  if (convention == ErrorConvention::kSo3xRn) {
    return c;
  }
  const bool right = convention == ErrorConvention::kRightInvariant;
  if (right) {
    c.template topLeftCorner<3, 3>() = inverse ? rotation : Matrix3d(rotation.transpose());
  }
  for (int i = 0; i < kSize / 3 - 1; ++i) {
    const int row = 3 * (i + 1);
    if (!right) {
      c.template block<3, 3>(row, row) = inverse ? Matrix3d(rotation.transpose()) : rotation;
    } else if (inverse) {
      c.template block<3, 3>(row, 0) = Skew(vectors[i]) * rotation;
    } else {
      c.template block<3, 3>(row, 0) = -Skew(vectors[i]);
    }
  }
  return c;
}

}  // namespace

std::optional<ErrorConvention> ParseErrorConvention(std::string_view name) {
  for (const ErrorConvention convention : kErrorConventions) {
    if (name == ToString(convention)) {
      return convention;
    }
  }
  return std::nullopt;
}

std::string_view ToString(ErrorConvention convention) {
  switch (convention) {
    case ErrorConvention::kRightInvariant:
      return "right_invariant";
    case ErrorConvention::kLeftInvariant:
      return "left_invariant";
    case ErrorConvention::kSo3xRn:
      break;
  }
  return "so3xrn";
}

std::string ErrorConventionNames(std::string_view separator) {
  std::string names;
  for (const ErrorConvention convention : kErrorConventions) {
    names += std::string(names.empty() ? "" : separator) + std::string(ToString(convention));
  }
  return names;
}

NavState Retract(ErrorConvention convention, const NavState& estimate, const Vector9d& xi) {
  const Vector3d theta = xi.head<3>();
  return {RetractRotation(convention, estimate.R_WB, theta),
          RetractVector(convention, estimate.R_WB, estimate.p_WB, theta, xi.segment<3>(3)),
          RetractVector(convention, estimate.R_WB, estimate.v_WB, theta, xi.tail<3>())};
}

Vector9d Local(ErrorConvention convention, const NavState& estimate, const NavState& truth) {
  Vector9d xi;
  xi.head<3>() = LocalRotation(convention, estimate.R_WB, truth.R_WB);
  xi.segment<3>(3) = LocalVector(convention, estimate.R_WB, truth.R_WB, estimate.p_WB, truth.p_WB);
  xi.tail<3>() = LocalVector(convention, estimate.R_WB, truth.R_WB, estimate.v_WB, truth.v_WB);
  return xi;
}

Matrix9d ChartJacobian(ErrorConvention convention, const NavState& estimate) {
  const Vector3d vectors[] = {estimate.p_WB, estimate.v_WB};
  return Chart<9>(convention, estimate.R_WB, vectors, false);
}

Matrix9d InverseChartJacobian(ErrorConvention convention, const NavState& estimate) {
  const Vector3d vectors[] = {estimate.p_WB, estimate.v_WB};
  return Chart<9>(convention, estimate.R_WB, vectors, true);
}

Pose Retract(ErrorConvention convention, const Pose& estimate, const Vector6d& xi) {
  const Vector3d theta = xi.head<3>();
  return {RetractRotation(convention, estimate.rotation, theta),
          RetractVector(convention, estimate.rotation, estimate.translation, theta, xi.tail<3>())};
}

Vector6d Local(ErrorConvention convention, const Pose& estimate, const Pose& truth) {
  Vector6d xi;
  xi.head<3>() = LocalRotation(convention, estimate.rotation, truth.rotation);
  xi.tail<3>() =
      LocalVector(convention, estimate.rotation, truth.rotation, estimate.translation, truth.translation);
  return xi;
}

Matrix6d ChartJacobian(ErrorConvention convention, const Pose& estimate) {
  return Chart<6>(convention, estimate.rotation, &estimate.translation, false);
}

Matrix6d InverseChartJacobian(ErrorConvention convention, const Pose& estimate) {
  return Chart<6>(convention, estimate.rotation, &estimate.translation, true);
}

Matrix15d ImuChartJacobian(ErrorConvention convention, const NavState& estimate) {
  Matrix15d c = Matrix15d::Identity();
  c.topLeftCorner<9, 9>() = ChartJacobian(convention, estimate);
  return c;
}

Matrix15d InverseImuChartJacobian(ErrorConvention convention, const NavState& estimate) {
  Matrix15d c = Matrix15d::Identity();
  c.topLeftCorner<9, 9>() = InverseChartJacobian(convention, estimate);
  return c;
}

}  // namespace alidade
