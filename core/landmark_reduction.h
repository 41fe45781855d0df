#pragma once

#include <Eigen/Core>
#include <span>

#include "core/navigation_state.h"
#include "core/visual_observation.h"

namespace alidade {

/// The whitened rows of one observation, linearised at a landmark held fixed.
struct ObservationRows {
  Eigen::Vector2d residual;                    ///< predicted - measured
  Eigen::Matrix<double, 2, 6> pose_jacobian;   ///< over (phi, dp) of the camera
  Eigen::Matrix<double, 2, 3> point_jacobian;  ///< over an additive error of p_W
};

/// Linearises one view at the landmark p_W. False, with nothing written, when it lies behind the camera.
bool LinearizeObservation(const Pose& T_WC, const NormalizedObservation& observation,
                          const Eigen::Vector3d& p_W, ObservationRows* rows);

/// The whitened rows of one track, linearised at a landmark held fixed, before the landmark is eliminated:
/// W_k r_k = W_k J_k zeta_k + W_k J_pi R_k^T f~ + n, n ~ N(0, I).
struct TrackLinearization {
  Eigen::VectorXd residual;  ///< 2N, whitened predicted - measured
  /// 2N x 6: view k's rows over its own camera's (phi, dp).
  Eigen::Matrix<double, Eigen::Dynamic, 6> pose_jacobians;
  Eigen::Matrix<double, Eigen::Dynamic, 3> point_jacobian;  ///< 2N x 3 over an additive error of p_W
};

/// Linearises every view at the landmark p_W. False when it lies behind one of them.
bool LinearizeTrack(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                    const Eigen::Vector3d& p_W, TrackLinearization* linearization);

/// The rows that do not depend on the landmark: N^T [H | r] with N the left null space of the point Jacobian;
/// at most 2N-3 rows, unit noise. With the total Jacobian H_X of PoseOnlyModel, N^T H_X is the same matrix:
/// the pose-only update is the MSCKF update on equal observations and linearisation point
/// (docs/pose_only.md).
///
/// `jacobian` is 2N x M with all state columns, `residual` 2N; both are overwritten, the first 3 rows then
/// hold the landmark's own rows (R_f, t) and the rest are the 2N-3 rows. `point_jacobian` is destroyed. Needs
/// N >= 2.
void EliminateLandmark(Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, 3>> point_jacobian,
                       Eigen::Ref<Eigen::MatrixXd> jacobian, Eigen::Ref<Eigen::VectorXd> residual);

}  // namespace alidade
