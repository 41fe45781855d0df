#include "smoother/tracks/track_landmark.h"

#include <cmath>

namespace alidade {
CameraViews::CameraViews(std::span<const WindowView> views, std::span<const FrameGeometry> geometry) {
  T_WC.reserve(views.size());
  observations.reserve(views.size());
  FrameGeometry scratch;
  for (const WindowView& view : views) {
    T_WC.push_back(AtRow(geometry, view, &scratch).T_WC);
    observations.push_back(view.observation);
  }
}

bool SolveLandmark(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                   const ObservationKernel& kernel, int max_iterations, Eigen::Vector3d* landmark,
                   const DepthPrior& prior, double* least) {
  const CameraViews cameras(views, geometry);
  return SolveLandmark(cameras.T_WC, cameras.observations, {max_iterations, kernel, prior}, landmark, least);
}

double TrackChiSquare(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                      const Eigen::Vector3d& landmark) {
  const CameraViews cameras(views, geometry);
  return LandmarkCost(cameras.T_WC, cameras.observations, {}, landmark);
}

bool InitializeLandmark(std::span<const WindowView> views, std::span<const FrameGeometry> geometry,
                        double max_relative_deviation, Eigen::Vector3d* landmark) {
  const CameraViews cameras(views, geometry);
  PoseOnlyDepth depth;
  if (!TriangulateLandmark(cameras.T_WC, cameras.observations, DepthViews::kMulti, max_relative_deviation,
                           &depth) ||
      !(std::abs(depth.depth) > 1e-9)) {
    return false;
  }
  *landmark << views.front().observation.z, 1.0 / depth.depth;
  return landmark->allFinite();
}

}  // namespace alidade
