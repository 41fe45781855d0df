#pragma once

#include <Eigen/Core>

#include "smoother/tracks/track_system.h"

namespace alidade {

/// A landmark l = (x, y, rho) of one camera (bearing on its normalised plane, inverse depth [1/m]) seen from
/// another: the scaled point of the target camera
///
///     q = R_t^T (R_s (x, y, 1) + rho (p_s - p_t)),
///
/// with its derivatives over (phi, dp) of both bodies, canonical chart. rho = 0 is regular.
class LandmarkTransfer {
 public:
  /// kNow: between the present cameras, for the value. kLinearized: where their Jacobians are taken.
  enum class At { kNow, kLinearized };
  LandmarkTransfer(const FrameGeometry& source, const FrameGeometry& target, const Eigen::Vector3d& l,
                   At at = At::kNow);

  Eigen::Vector3d q;
  Eigen::Matrix3d landmark;  ///< dq / dl

  [[nodiscard]] Eigen::Matrix<double, 3, 6> SourceFrame() const;  ///< dq / d source body
  [[nodiscard]] Eigen::Matrix<double, 3, 6> TargetFrame() const;  ///< dq / d target body
  /// dq / d calibration of the camera that both are, in the layout's columns.
  [[nodiscard]] Eigen::Matrix3Xd Calibration(const CalibrationLayout& layout) const;

 private:
  [[nodiscard]] Eigen::Matrix<double, 3, 6> SourceCamera() const;
  [[nodiscard]] Eigen::Matrix<double, 3, 6> TargetCamera() const;

  const FrameGeometry* source_;
  const FrameGeometry* target_;
  Eigen::Vector3d l_;
  Eigen::Matrix3d R_WT_;  ///< of the target camera
  Eigen::Matrix3d turn_;  ///< R_t^T R_s
};

/// The whitened rows of one view of a landmark that is anchored in another frame's camera, and moves with it:
/// what LinearizeView gives for a point of the world.
struct AnchoredRows {
  Eigen::Matrix<double, 2, 6> anchor;    ///< over (phi, dp) of the anchor's body
  Eigen::Matrix<double, 2, 6> view;      ///< over (phi, dp) of the view's body
  Eigen::Matrix<double, 2, 3> landmark;  ///< over (x, y, rho)
  Eigen::Matrix2Xd calibration;          ///< over the camera's calibration, where it is estimated
  Eigen::Vector2d residual;              ///< predicted - measured
  double squared_norm = 0;               ///< of the residual
  double weight = 1;                     ///< of all rows: the kernel's
};
/// False behind the view. `with_frames` false leaves out the derivatives over bodies and calibration, and
/// takes the landmark's at the present cameras: those it is solved for with.
/// `calibration`: of a camera that is calibrated online.
bool LinearizeAnchoredView(const FrameGeometry& anchor, const FrameGeometry& view,
                           const NormalizedObservation& observation, const ObservationKernel& kernel,
                           const Eigen::Vector3d& landmark, AnchoredRows* rows, bool with_frames = true,
                           const WindowCalibration* calibration = nullptr);

/// Sum of whitened squared residuals (no kernel) of a track at its landmark, SLAM feature or not; infinite
/// when behind a view.
[[nodiscard]] double TrackChiSquare(const WindowTrack& track, std::span<const FrameGeometry> geometry);

/// A landmark of the anchor's camera in coordinates of another: l_from as a function of l_to, both bodies and
/// the calibration of the camera, whose extrinsics and time offset say where the two cameras are.
struct AnchorChange {
  Eigen::Vector3d to;                      ///< the landmark in its new anchor
  Eigen::Matrix3d landmark;                ///< d l_from / d l_to
  Eigen::Matrix<double, 3, 6> from_frame;  ///< d l_from / d (phi, dp) of the old anchor's body
  Eigen::Matrix<double, 3, 6> to_frame;    ///< d l_from / d (phi, dp) of the new anchor's body
  Eigen::Matrix3Xd calibration;            ///< d l_from / d calibration, where a layout is given
};
/// False when the landmark lies behind the new anchor's camera.
bool ChangeAnchor(const FrameGeometry& from, const FrameGeometry& to, const Eigen::Vector3d& l_from,
                  AnchorChange* change, const CalibrationLayout* layout = nullptr);

}  // namespace alidade
