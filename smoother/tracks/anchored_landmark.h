#pragma once

#include <Eigen/Core>

#include "smoother/tracks/track_landmark.h"

namespace alidade {

/// The whitened rows of one view of a landmark that is anchored in another frame's camera, and moves with it:
/// what LinearizeView gives for a point of the world.
struct AnchoredRows {
  Eigen::Matrix<double, 2, 6> anchor;    ///< over (phi, dp) of the anchor's body
  Eigen::Matrix<double, 2, 6> view;      ///< over (phi, dp) of the view's body
  Eigen::Matrix<double, 2, 3> landmark;  ///< over (x, y, rho)
  CalibrationRowPair calibration;        ///< over the camera's calibration
  Eigen::Vector2d residual;              ///< predicted - measured
  double squared_norm = 0;               ///< of the residual
  double weight = 1;                     ///< of all rows: the kernel's
};
/// False behind the view. `with_frames` false leaves out the derivatives over bodies and calibration, and
/// takes the landmark's at the present cameras: those it is solved for with.
/// `plane`: of the anchor, that of the landmark's
/// coordinates.
bool LinearizeAnchoredView(const FrameGeometry& anchor, const FrameGeometry& view,
                           const NormalizedObservation& observation, const ObservationKernel& kernel,
                           const Eigen::Vector3d& landmark, AnchoredRows* rows, bool with_frames = true,
                           const WindowCalibration& calibration = NotCalibrated(),
                           const BearingPlane& plane = kNormalizedPlane);
/// The same of a view of a SLAM feature's track, at a landmark in the track's anchor. `geometry`: of every
/// frame.
bool LinearizeAnchoredView(const WindowTrack& track, const WindowView& view,
                           std::span<const FrameGeometry> geometry, const ObservationKernel& kernel,
                           const Eigen::Vector3d& landmark, AnchoredRows* rows, bool with_frames,
                           const WindowCalibration& calibration);

/// Sum of whitened squared residuals (no kernel) of a track at its landmark, SLAM feature or not; infinite
/// when behind a view.
[[nodiscard]] double TrackChiSquare(const WindowTrack& track, std::span<const FrameGeometry> geometry);

/// A landmark of the anchor's camera in coordinates of another: l_from as a function of l_to, both bodies and
/// the calibration of the camera, whose extrinsics and time offset give the poses of the two cameras.
struct AnchorChange {
  Eigen::Vector3d to;                      ///< the landmark in its new anchor
  Eigen::Matrix3d landmark;                ///< d l_from / d l_to
  Eigen::Matrix<double, 3, 6> from_frame;  ///< d l_from / d (phi, dp) of the old anchor's body
  Eigen::Matrix<double, 3, 6> to_frame;    ///< d l_from / d (phi, dp) of the new anchor's body
  Eigen::Matrix3Xd calibration;            ///< d l_from / d calibration
};
/// Planes of the coordinates l_from and l_to.
struct AnchorPlanes {
  BearingPlane from, to;
};
/// False when the landmark lies behind the new anchor's camera, or its plane.
bool ChangeAnchor(const FrameGeometry& from, const FrameGeometry& to, const Eigen::Vector3d& l_from,
                  AnchorChange* change, const CalibrationLayout& layout = {},
                  const AnchorPlanes& planes = {});
/// The plane that a landmark of `from` gets in the camera `to`: tangent at its ray there if it was before.
[[nodiscard]] BearingPlane PlaneInAnchor(const FrameGeometry& from, const BearingPlane& from_plane,
                                         const FrameGeometry& to, const Eigen::Vector3d& l_from);

}  // namespace alidade
