#include "smoother/tracks/outlying_views.h"

#include <cmath>

#include "core/landmark_reduction.h"
#include "core/outlying_observations.h"
#include "smoother/tracks/anchored_landmark.h"
#include "smoother/tracks/track_landmark.h"
#include "smoother/tracks/track_system.h"

namespace alidade {

using Eigen::Index;

bool FindOutlyingViews(const WindowTrack& track, std::span<const FrameGeometry> geometry,
                       const ChiSquareGate& gate, double noise_variance, std::vector<int>* outlying) {
  const Index rows = 2 * static_cast<Index>(track.views.size());
  Eigen::VectorXd residual(rows);
  Eigen::Matrix<double, Eigen::Dynamic, 3> point_jacobian(rows, 3);
  FrameGeometry base_row;
  FrameGeometry view_row;
  for (Index k = 0; 2 * k < rows; ++k) {
    const WindowView& view = track.views[static_cast<size_t>(k)];
    if (track.anchor != nullptr) {
      AnchoredRows seen;
      if (!LinearizeAnchoredView(track, view, geometry, {}, track.landmark, &seen, false, NotCalibrated())) {
        return false;
      }
      residual.segment<2>(2 * k) = seen.residual;
    } else {
      ViewRows seen;
      if (!LinearizeView(AtRow(geometry, track.views.front(), &base_row), AtRow(geometry, view, &view_row),
                         view.observation, {}, track.landmark, &seen, track.plane())) {
        return false;
      }
      residual.segment<2>(2 * k) = seen.residual;
      point_jacobian.middleRows<2>(2 * k) = seen.landmark;
    }
  }
  residual /= std::sqrt(noise_variance);
  Eigen::MatrixXd maps = Eigen::MatrixXd::Identity(rows, rows);
  const Index landmark = track.anchor != nullptr ? 0 : 3;
  if (landmark > 0) {
    EliminateLandmark(point_jacobian, maps, residual);
  }
  return FindOutlyingObservations(gate, maps.bottomRows(rows - landmark), residual.tail(rows - landmark),
                                  outlying);
}

bool FindOutliersOfConsensus(const WindowTrack& track, std::span<const FrameGeometry> geometry,
                             std::vector<int>* outlying) {
  const CameraViews cameras(track.views, geometry);
  return FindOutliersOfConsensus(cameras.T_WC, cameras.observations, outlying);
}

}  // namespace alidade
