#pragma once

#include <Eigen/Core>
#include <span>

#include "core/pose_only.h"
#include "core/robust.h"

// The landmark of a track with the poses held fixed: triangulation, then Gauss-Newton on its reprojection.
// Poses and observations are those of the track's views, one each; the first view is the base.

namespace alidade {

/// The pose-only depth of the views, base first (core/pose_only.h). False when they do not determine it: no
/// parallax, or a relative deviation of max_relative_deviation or more (DepthIsDetermined). The noise is
/// taken from the last view: that of the base may be inflated. The depth may be negative: the caller checks.
bool TriangulateLandmark(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                         DepthViews views, double max_relative_deviation, PoseOnlyDepth* depth);

/// Weak prior on a landmark's inverse depth, for tracks without parallax: sqrt_information (rho - mean). Such
/// a track (at rest, or far away) still constrains rotation and shows that the camera did not move; without
/// it both would depend on the IMU.
struct DepthPrior {
  double mean = 0;              ///< [1/m]
  double sqrt_information = 0;  ///< [m]; 0: no prior
};

struct LandmarkOptions {
  int max_iterations = 30;
  ObservationKernel kernel;
  DepthPrior depth_prior;
  bool finite_depth = false;  ///< takes rho <= 0 for a landmark behind its views; else it is regular
};

/// Sum over the views of rho(|W (pi - z)|^2), plus the squared residual of the depth prior, of the landmark
/// (x, y, rho) anchored in the base view (AnchoredPointInCamera), on its observation's plane. Infinite when
/// it lies behind a view.
[[nodiscard]] double LandmarkCost(std::span<const Pose> T_WC,
                                  std::span<const NormalizedObservation> observations,
                                  const LandmarkOptions& options, const Eigen::Vector3d& landmark);

/// Minimises LandmarkCost over (x, y, rho): damped, iteratively re-weighted Gauss-Newton, until a step would
/// lower the cost by less than 1e-14 of it, so that the cost's derivative through the landmark vanishes.
/// `landmark` is start and result, `least` the cost there. False: behind a view at the start, or not finite.
bool SolveLandmark(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                   const LandmarkOptions& options, Eigen::Vector3d* landmark, double* least = nullptr);

/// The same for a point of the world in front of all views, without kernel and prior: p_W is start and
/// result. False when it does not stay in front of every view; p_W is then untouched.
bool RefineLandmark(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                    int max_iterations, Eigen::Vector3d* p_W);

}  // namespace alidade
