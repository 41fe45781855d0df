#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/pose_only.h"

namespace alidade::test {

/// Observations of unit noise.
inline std::vector<NormalizedObservation> UnitNoise(std::span<const Eigen::Vector2d> z) {
  std::vector<NormalizedObservation> observations;
  for (const Eigen::Vector2d& each : z) {
    observations.push_back({each, Eigen::Matrix2d::Identity()});
  }
  return observations;
}

/// Multi-view pose-only reprojection (paper eq. 5-7, 5-8): residual of every view against the landmark that
/// ALL poses and observations define, with total derivatives. An oracle: the estimators hold the landmark
/// fixed and eliminate it (core/landmark_reduction.h). The projection is written out again here.
struct PoseOnlyModel {
  int base = 0;
  DepthViews views = DepthViews::kMulti;

  /// residual: 2N, predicted - measured; the base's two rows vanish. jacobian: 2N x 6N over the views' (phi,
  /// dp). noise_jacobian: 2N x 2N, d predicted / d z (so that residual noise is (noise_jacobian - I) n); null
  /// skips. False: no parallax, or the landmark lies behind a view.
  bool Evaluate(std::span<const Pose> T_WC, std::span<const Eigen::Vector2d> z, PoseOnlyDepth* depth,
                Eigen::VectorXd* residual, Eigen::MatrixXd* jacobian, Eigen::MatrixXd* noise_jacobian) const {
    PoseOnlyJacobians point;
    const bool differentiate = jacobian != nullptr || noise_jacobian != nullptr;
    if (!ComputePoseOnlyDepth(T_WC, UnitNoise(z), base, views, depth, differentiate ? &point : nullptr)) {
      return false;
    }
    const auto count = static_cast<Eigen::Index>(T_WC.size());
    residual->resize(2 * count);
    if (jacobian != nullptr) {
      jacobian->resize(2 * count, 6 * count);
    }
    if (noise_jacobian != nullptr) {
      noise_jacobian->resize(2 * count, 2 * count);
    }
    for (Eigen::Index k = 0; k < count; ++k) {
      const Pose& view = T_WC[static_cast<size_t>(k)];
      const Eigen::Vector3d p = view.Inverse() * depth->p_W;
      if (!(p.z() > 0)) {
        return false;
      }
      residual->segment<2>(2 * k) = p.head<2>() / p.z() - z[static_cast<size_t>(k)];
      Eigen::Matrix<double, 2, 3> over_p;
      over_p << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
      const Eigen::Matrix<double, 2, 3> over_point = over_p * view.rotation.transpose();
      if (jacobian != nullptr) {
        jacobian->middleRows<2>(2 * k) = over_point * point.poses;
        jacobian->block<2, 3>(2 * k, 6 * k) += over_p * Skew(p);
        jacobian->block<2, 3>(2 * k, 6 * k + 3) -= over_point;
      }
      if (noise_jacobian != nullptr) {
        noise_jacobian->middleRows<2>(2 * k) = over_point * point.observations;
      }
    }
    return true;
  }
};

}  // namespace alidade::test
