#pragma once

#include <Eigen/Core>
#include <type_traits>

#include "core/bearing_plane.h"
#include "core/navigation_state.h"

// The reprojection of a landmark, the one of this library: where a camera sees it on the plane of its
// observation (core/bearing_plane.h), and the derivatives of that. Every visual model, solver and factor
// composes what stands here.
//
// Derivatives come as a chain. A model forms its rows over q, the landmark in the camera's frame: those of
// the projection, whitened where it needs them so. Chain() carries the rows to what q depends on. Cameras are
// in the canonical chart (phi, dp) of core/model.h; where the pose of a camera depends on a body, extrinsics
// or a time offset, the rows over the camera go on through BodyToCameraJacobian (core/visual_observation.h)
// and CalibrationRows (core/calibration.h).

namespace alidade {

/// kRows rows over a point, and over the (phi, dp) of a pose.
template <int kRows>
using PointRows = Eigen::Matrix<double, kRows, 3>;
template <int kRows>
using PoseRows = Eigen::Matrix<double, kRows, 6>;

/// d pi / dq of pi(q) = (q_x, q_y) / q_z, at a point of depth q_z that is seen at `projected`:
/// [ 1 0 -pi_x ; 0 1 -pi_y ] / q_z, 2x3.
[[nodiscard]] inline PointRows<2> ProjectionJacobian(const Eigen::Vector2d& projected, double depth) {
  PointRows<2> jacobian;
  jacobian << 1, 0, -projected.x(), 0, 1, -projected.y();
  return jacobian / depth;
}

/// What a depth q_z must exceed for a point of the world [m], and for an anchored landmark scaled by its
/// inverse depth (a number without a unit, about 1 for a distant landmark).
inline constexpr double kMinPointDepth = 0;
inline constexpr double kMinScaledDepth = 1e-6;

/// Projects a point q of the camera frame, or any positive multiple of it, onto the ideal normalised plane.
/// jacobian: d pi / dq. False, with the outputs untouched, unless q_z > min_depth.
[[nodiscard]] inline bool ProjectToPlane(const Eigen::Vector3d& q, double min_depth,
                                         Eigen::Vector2d* projected, PointRows<2>* jacobian = nullptr) {
  if (!(q.z() > min_depth)) {
    return false;
  }
  *projected = q.head<2>() / q.z();
  if (jacobian != nullptr) {
    *jacobian = ProjectionJacobian(*projected, q.z());
  }
  return true;
}

/// The same onto the plane of an observation. The depth is along the plane's normal: on a tangent plane, a
/// point less than 90 degrees from what was measured is in front.
[[nodiscard]] inline bool ProjectToPlane(const BearingPlane& plane, const Eigen::Vector3d& q,
                                         double min_depth, Eigen::Vector2d* projected,
                                         PointRows<2>* jacobian = nullptr) {
  if (!ProjectToPlane(plane.InAxes(q), min_depth, projected, jacobian)) {
    return false;
  }
  if (jacobian != nullptr && plane.is_tangent()) {
    *jacobian = plane.OverCamera<2>(*jacobian);
  }
  return true;
}

/// A point of the world in a camera: q = R^T (p_W - p) [m], T_WC = (R, p).
struct PointInCamera {
  /// T_WC must outlive it.
  PointInCamera(const Pose& T_WC, const Eigen::Vector3d& p_W)
      : camera(&T_WC), q(T_WC.rotation.transpose() * (p_W - T_WC.translation)) {}

  /// Rows over q (kRows x 3) to rows over the camera, dq = [q]x phi - R^T dp, and over p_W, dq = R^T dp_W.
  /// A null output is skipped.
  template <int kRows>
  void Chain(const PointRows<kRows>& rows, std::type_identity_t<PoseRows<kRows>>* over_camera,
             std::type_identity_t<PointRows<kRows>>* over_point) const {
    const PointRows<kRows> over_world = rows * camera->rotation.transpose();
    if (over_camera != nullptr) {
      over_camera->template leftCols<3>() = rows * Skew(q);
      over_camera->template rightCols<3>() = -over_world;
    }
    if (over_point != nullptr) {
      *over_point = over_world;
    }
  }

  const Pose* camera;
  Eigen::Vector3d q;
};

/// A landmark anchored in camera A, l = (x, y, rho): its bearing on a plane of A's with axes R_P (core/
/// bearing_plane.h) and its inverse depth along the plane's normal [1/m]. In camera C, scaled by rho:
///
///     q = R_C^T (R_A R_P (x, y, 1) + rho (p_A - p_C)),
///
/// so that rho = 0, a landmark at infinity, is regular. R_P is the identity on the plane z = 1.
struct AnchoredPointInCamera {
  /// The poses and the plane, which is the anchor's, must outlive it.
  AnchoredPointInCamera(const Pose& T_WA, const Pose& T_WC, const Eigen::Vector3d& l,
                        const BearingPlane& of_anchor = kNormalizedPlane)
      : anchor(&T_WA),
        camera(&T_WC),
        plane(&of_anchor),
        landmark(l),
        shift_W(T_WA.translation - T_WC.translation) {
    const Eigen::Vector3d ray_W = T_WA.rotation * Ray();
    q = T_WC.rotation.transpose() * (ray_W + l.z() * shift_W);
  }

  /// Rows over q (kRows x 3) to rows over the cameras and over (x, y, rho):
  ///
  ///     dq = -R_C^T R_A [R_P (x, y, 1)]x phi_A + rho R_C^T dp_A,   dq = [q]x phi_C - rho R_C^T dp_C,
  ///     dq = R_C^T [ R_A R_P e_x  R_A R_P e_y  p_A - p_C ] dl.
  ///
  /// A null output is skipped. Seen from its own anchor (A = C) a landmark does not depend on the camera: the
  /// rows over the two cameras then cancel.
  template <int kRows>
  void Chain(const PointRows<kRows>& rows, std::type_identity_t<PoseRows<kRows>>* over_anchor,
             std::type_identity_t<PoseRows<kRows>>* over_camera,
             std::type_identity_t<PointRows<kRows>>* over_landmark) const {
    const PointRows<kRows> over_world = rows * camera->rotation.transpose();
    if (over_anchor != nullptr) {
      over_anchor->template leftCols<3>() = -over_world * anchor->rotation * Skew(Ray());
      over_anchor->template rightCols<3>() = landmark.z() * over_world;
    }
    if (over_camera != nullptr) {
      over_camera->template leftCols<3>() = rows * Skew(q);
      over_camera->template rightCols<3>() = -landmark.z() * over_world;
    }
    if (over_landmark != nullptr) {
      if (plane->is_tangent()) {
        over_landmark->template leftCols<2>() =
            over_world * anchor->rotation * plane->axes().template leftCols<2>();
      } else {
        over_landmark->template leftCols<2>() = over_world * anchor->rotation.leftCols<2>();
      }
      over_landmark->col(2) = over_world * shift_W;
    }
  }

  /// R_P (x, y, 1)
  [[nodiscard]] Eigen::Vector3d Ray() const { return plane->Direction(landmark.head<2>()); }

  const Pose* anchor;
  const Pose* camera;
  const BearingPlane* plane;  ///< of the anchor
  Eigen::Vector3d landmark;
  Eigen::Vector3d shift_W;  ///< p_A - p_C
  Eigen::Vector3d q;
};

}  // namespace alidade
