#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/landmark_solver.h"
#include "core/robust.h"
#include "smoother/window/frame_geometry.h"

namespace alidade {

// The landmark of a track, the poses held fixed.

/// A track's views as core/landmark_solver.h takes them.
struct CameraViews {
  CameraViews(std::span<const WindowView> views, std::span<const FrameGeometry> geometry);
  std::vector<Pose> T_WC;
  std::vector<NormalizedObservation> observations;
};

/// Landmark of the track with the poses held fixed (core/landmark_solver.h), and its cost.
bool SolveLandmark(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                   const ObservationKernel& kernel, int max_iterations, Eigen::Vector3d* landmark,
                   const DepthPrior& prior = {}, double* least = nullptr);

/// Sum of whitened squared residuals (no kernel) at the landmark; infinite when behind a view.
[[nodiscard]] double TrackChiSquare(std::span<const WindowView> views,
                                    std::span<const FrameGeometry> geometry, const Eigen::Vector3d& landmark);

/// First value of a landmark from its pose-only depth. False without parallax (TriangulateLandmark).
bool InitializeLandmark(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                        double max_relative_deviation, Eigen::Vector3d* landmark);

}  // namespace alidade
