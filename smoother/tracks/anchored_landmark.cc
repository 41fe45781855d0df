#include "smoother/tracks/anchored_landmark.h"

#include <limits>

#include "core/inverse_depth.h"
#include "core/predicted_observation.h"
#include "core/reprojection.h"

namespace alidade {

bool LinearizeAnchoredView(const FrameGeometry& anchor, const FrameGeometry& view,
                           const NormalizedObservation& observation, const ObservationKernel& kernel,
                           const Eigen::Vector3d& landmark, AnchoredRows* rows, bool with_frames,
                           const WindowCalibration& calibration, const BearingPlane& plane) {
  const InverseDepthModel model{observation.z, observation.plane, plane};
  const Eigen::Matrix2d& whitening = observation.sqrt_information;
  InverseDepthModel::PoseJacobian over_anchor;
  InverseDepthModel::PoseJacobian over_view;
  InverseDepthModel::LandmarkJacobian over_landmark;
  Eigen::Vector2d residual;
  if (!model.Evaluate(anchor.T_WC, view.T_WC, landmark, &residual, with_frames ? &over_anchor : nullptr,
                      with_frames ? &over_view : nullptr, &over_landmark)) {
    return false;
  }
  rows->residual = whitening * residual;
  if (with_frames && (anchor.T_WC_first || view.T_WC_first) &&
      !model.Evaluate(anchor.Linearized(), view.Linearized(), landmark, &residual, &over_anchor, &over_view,
                      &over_landmark)) {
    return false;
  }
  rows->landmark = whitening * over_landmark;
  rows->squared_norm = rows->residual.squaredNorm();
  rows->weight = kernel.Weight(rows->squared_norm);
  if (with_frames) {
    rows->anchor = whitening * over_anchor * anchor.camera_from_body;
    rows->view = whitening * over_view * view.camera_from_body;
    const CalibrationLayout& layout = calibration.layout;
    // The ray's part; the cameras' places follow.
    rows->calibration.resize(2, layout.size());
    CalibrationRows(layout, calibration.mean.camera, view.R_WB, {}, Eigen::Matrix<double, 2, 6>::Zero(),
                    Predicted(observation, rows->residual), rows->calibration);
    rows->calibration += whitening * (over_anchor * CalibrationChain(layout, anchor) +
                                      over_view * CalibrationChain(layout, view));
  }
  return true;
}

bool LinearizeAnchoredView(const WindowTrack& track, const WindowView& view,
                           std::span<const FrameGeometry> geometry, const ObservationKernel& kernel,
                           const Eigen::Vector3d& landmark, AnchoredRows* rows, bool with_frames,
                           const WindowCalibration& calibration) {
  FrameGeometry row;
  return LinearizeAnchoredView(geometry[static_cast<size_t>(track.anchor->index)],
                               AtRow(geometry, view, &row), view.observation, kernel, landmark, rows,
                               with_frames, calibration, track.plane());
}

double TrackChiSquare(const WindowTrack& track, std::span<const FrameGeometry> geometry) {
  if (track.anchor == nullptr) {
    return TrackChiSquare(track.views, geometry, track.landmark);
  }
  double chi2 = 0;
  AnchoredRows rows;
  for (const WindowView& view : track.views) {
    if (!LinearizeAnchoredView(track, view, geometry, {}, track.landmark, &rows, false, NotCalibrated())) {
      return std::numeric_limits<double>::infinity();
    }
    chi2 += rows.squared_norm;
  }
  return chi2;
}

bool ChangeAnchor(const FrameGeometry& from, const FrameGeometry& to, const Eigen::Vector3d& l_from,
                  AnchorChange* change, const CalibrationLayout& layout, const AnchorPlanes& planes) {
  const Eigen::Vector3d q_to =
      planes.to.InAxes(AnchoredPointInCamera(from.T_WC, to.T_WC, l_from, planes.from).q);
  Eigen::Vector2d bearing;
  if (!ProjectToPlane(q_to, kMinScaledDepth, &bearing)) {
    return false;
  }
  change->to << bearing, l_from.z() / q_to.z();
  // Back: l_from = (pi(q), rho_to / q_z), q in the axes of the plane.
  const AnchoredPointInCamera back(to.Linearized(), from.Linearized(), change->to, planes.to);
  const double depth = planes.from.InAxes(back.q).z();
  Eigen::Matrix3d over_q = Eigen::Matrix3d::Zero();
  over_q.topRows<2>() = ProjectionJacobian(l_from.head<2>(), depth);
  over_q(2, 2) = -l_from.z() / depth;
  over_q = planes.from.OverCamera<3>(over_q);
  PoseRows<3> over_from;
  PoseRows<3> over_to;
  back.Chain(over_q, &over_to, &over_from, &change->landmark);
  change->landmark(2, 2) += 1 / depth;
  change->from_frame.noalias() = over_from * from.camera_from_body;
  change->to_frame.noalias() = over_to * to.camera_from_body;
  change->calibration = over_to * CalibrationChain(layout, to) + over_from * CalibrationChain(layout, from);
  return true;
}

BearingPlane PlaneInAnchor(const FrameGeometry& from, const BearingPlane& from_plane, const FrameGeometry& to,
                           const Eigen::Vector3d& l_from) {
  if (!from_plane.is_tangent()) {
    return from_plane;
  }
  return BearingPlane::TangentAt(AnchoredPointInCamera(from.T_WC, to.T_WC, l_from, from_plane).q);
}

}  // namespace alidade
