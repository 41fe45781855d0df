#pragma once

#include <Eigen/Core>

namespace alidade {

/// A plane on which the directions of a camera are points: at distance 1 from its centre, with axes R = [e_x
/// e_y n] in the camera's frame, n its normal. A direction R (x, y, 1) is the point (x, y).
///
/// Two kinds are in use. The ideal normalised plane z = 1, R the identity, carries directions before the
/// camera only, and near its edge a direction's error grows as 1 / cos^2 of the angle off axis. The tangent
/// plane of the unit sphere at a measured direction u (n = u) carries a residual wherever u points: with B =
/// [e_x e_y] an orthonormal basis of the tangent plane, the point of a direction q is B^T q / u^T q. That is
/// B^T (q / |q| - u), the difference of the unit directions seen in the tangent plane, but for a factor 1 /
/// cos of the angle between them (1 + 1e-4 at one degree), and grows with that angle up to 90 degrees, where
/// the difference would begin to shrink.
class BearingPlane {
 public:
  /// The plane z = 1.
  BearingPlane() = default;
  /// The plane that touches the unit sphere at `direction`, of any length but zero.
  [[nodiscard]] static BearingPlane TangentAt(const Eigen::Vector3d& direction) {
    BearingPlane plane;
    plane.tangent_ = true;
    const Eigen::Vector3d n = direction.normalized();
    // Duff et al., Building an Orthonormal Basis, Revisited (JCGT 2017): smooth but at n = -e_z.
    const double sign = n.z() < 0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + n.z());
    const double b = n.x() * n.y() * a;
    plane.axes_.col(0) << 1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x();
    plane.axes_.col(1) << b, sign + n.y() * n.y() * a, -n.y();
    plane.axes_.col(2) = n;
    return plane;
  }

  /// False: the plane z = 1.
  [[nodiscard]] bool is_tangent() const { return tangent_; }
  /// R.
  [[nodiscard]] const Eigen::Matrix3d& axes() const { return axes_; }
  /// The direction of a point: R (x, y, 1).
  [[nodiscard]] Eigen::Vector3d Direction(const Eigen::Vector2d& point) const {
    const Eigen::Vector3d direction(point.x(), point.y(), 1);
    return tangent_ ? Eigen::Vector3d(axes_ * direction) : direction;
  }
  /// A vector of the camera's frame in the plane's axes: R^T v.
  [[nodiscard]] Eigen::Vector3d InAxes(const Eigen::Vector3d& v) const {
    return tangent_ ? Eigen::Vector3d(axes_.transpose() * v) : v;
  }
  /// Rows over a vector in the plane's axes to rows over the vector in the camera's frame: times R^T.
  template <int kRows>
  [[nodiscard]] Eigen::Matrix<double, kRows, 3> OverCamera(
      const Eigen::Matrix<double, kRows, 3>& rows) const {
    return tangent_ ? Eigen::Matrix<double, kRows, 3>(rows * axes_.transpose()) : rows;
  }

 private:
  bool tangent_ = false;
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();
};

/// The plane z = 1, for references to it.
inline const BearingPlane kNormalizedPlane;

}  // namespace alidade
