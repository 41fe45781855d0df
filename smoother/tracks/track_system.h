#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/landmark_solver.h"
#include "core/robust.h"
#include "smoother/window/column_map.h"
#include "smoother/window/frame_geometry.h"

namespace alidade {

/// Normal equations of vision alone, every landmark eliminated (the 2N-3 rows N^T [H | r] of each track; N
/// the left null space of its point Jacobian): over (phi, dp) of each frame's body pose in the canonical
/// chart.
struct PoseSystem {
  /// calibration: it must outlive the system.
  explicit PoseSystem(int frames, const WindowCalibration* calibration = &NotCalibrated());

  const WindowCalibration* calibration;
  ColumnMap columns;        ///< the frames' poses in order, then the calibration
  Eigen::MatrixXd hessian;  ///< lower triangle
  Eigen::VectorXd gradient;
  double robust_cost = 0;  ///< sum of rho(s) (twice the cost)
  double chi2 = 0;         ///< sum of s, no kernel
  int dof = 0;             ///< sum of 2N-3
  int tracks = 0;
};

/// The whitened rows of one view of a track, before the landmark is eliminated.
struct ViewRows {
  Eigen::Matrix<double, 2, 6> camera;    ///< over (phi, dp) of the view's camera pose, canonical chart
  Eigen::Matrix<double, 2, 6> pose;      ///< over (phi, dp) of the view's body pose, canonical chart
  Eigen::Matrix<double, 2, 3> landmark;  ///< over (x, y, rho)
  Eigen::Vector2d residual;              ///< predicted - measured
  double squared_norm = 0;               ///< of the residual
  double weight = 1;                     ///< of both rows: the kernel's
};

/// Linearises one view, its Jacobians at first estimates where the frames have such. The landmark's three
/// coordinates (x, y, rho) are taken in the base camera's frame as it is NOW, `base`, which then stands
/// still: a point of the world. So every row, the base's too, concerns one pose, and rho = 0 is regular.
/// `base_plane`: of the base's observation. False behind the view.
bool LinearizeView(const FrameGeometry& base, const FrameGeometry& frame,
                   const NormalizedObservation& observation, const ObservationKernel& kernel,
                   const Eigen::Vector3d& landmark, ViewRows* rows,
                   const BearingPlane& base_plane = kNormalizedPlane);

/// d rho / d (phi, dp) of the base camera, rho being the inverse depth in the base view of a landmark that is
/// a point of the world, as LinearizeView has it.
[[nodiscard]] Eigen::Matrix<double, 1, 6> InverseDepthRow(const FrameGeometry& base,
                                                          const Eigen::Vector3d& landmark,
                                                          const BearingPlane& base_plane = kNormalizedPlane);

/// A landmark as AddTrack eliminates it. Its step in the joint Gauss-Newton step with states and calibration
/// is
///
///     df = -T (T^T g + sum over the views of (B_k^T A_k T)^T dx_k + C^T dc),   T T^T = (A^T A)^-1,
///
/// A_k, B_k, r_k the whitened rows and residual of a view times the root of the kernel's weight, g = A^T r.
struct EliminatedLandmark {
  using Calibration =
      Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, CalibrationLayout::kMaxSize, 3>;

  Eigen::Matrix3d root;                            ///< T
  Eigen::Vector3d gradient;                        ///< T^T g
  std::vector<Eigen::Matrix<double, 6, 3>> poses;  ///< B_k^T A_k T, over (phi, dp) of each view's body
  Calibration calibration;                         ///< C, over the layout's coordinates
};

/// Scratch space of AddTrack, reused from track to track.
struct TrackWorkspace {
  std::vector<Eigen::Index> first;  ///< column of the system where each view's pose begins
  std::vector<ViewRows> rows;
  std::vector<Eigen::Matrix<double, 6, 3>> coupling;  ///< B_k^T A_k
  Eigen::Matrix3d landmark_hessian;
  Eigen::Vector3d landmark_gradient;
  Matrix6d prior_hessian;                  ///< of the depth prior, over the base view's pose
  Vector6d prior_gradient;                 ///< likewise
  Eigen::Matrix<double, 1, 6> prior_pose;  ///< its row there
  Eigen::RowVectorXd prior_calibration;    ///< the depth prior's row over the calibration
  double prior_residual = 0;
  double robust_cost = 0;
  double chi2 = 0;
  EliminatedLandmark eliminated;
};

/// Adds one track, linearised at its landmark (x, y, rho), to the system; a landmark that is not at its
/// optimum is stepped there to first order. rho <= 0 (a point at infinity, or beyond) is regular.
/// False (system untouched): behind a view, or the landmark is not determined.
bool AddTrack(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
              const ObservationKernel& kernel, const Eigen::Vector3d& landmark, TrackWorkspace* workspace,
              PoseSystem* system, const DepthPrior& prior = {});

/// Standard deviation of a track's inverse depth in its base view, the poses held fixed. nullopt: behind a
/// view, or the views do not determine the landmark.
[[nodiscard]] std::optional<double> InverseDepthDeviation(std::span<const WindowView> views,
                                                          std::span<const FrameGeometry> geometry,
                                                          const ObservationKernel& kernel,
                                                          const Eigen::Vector3d& landmark);

/// Rows [J | r] with J^T J = H and J^T r = g: upper-triangular Cholesky factor of a positive SEMI-definite H
/// (lower triangle given). Directions without information (pivot below 1e-13 of the diagonal) give zero rows.
void SquareRootRows(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                    Eigen::MatrixXd* jacobian, Eigen::VectorXd* residual);

}  // namespace alidade
