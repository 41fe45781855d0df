#include "smoother/tracks/anchored_landmark.h"

#include <limits>

#include "core/predicted_observation.h"
#include "core/robust.h"

namespace alidade {
namespace {

constexpr double kMinViewDepth = 1e-6;  // of the scaled point

/// d (q.x / q.z, q.y / q.z) / dq, times q.z.
Eigen::Matrix<double, 2, 3> Perspective(const Eigen::Vector2d& projected) {
  Eigen::Matrix<double, 2, 3> perspective;
  perspective << 1, 0, -projected.x(), 0, 1, -projected.y();
  return perspective;
}

}  // namespace

LandmarkTransfer::LandmarkTransfer(const FrameGeometry& source, const FrameGeometry& target,
                                   const Eigen::Vector3d& l, At at)
    : source_(&source), target_(&target), l_(l) {
  const Pose& from = at == At::kNow ? source.T_WC : source.Linearized();
  const Pose& to = at == At::kNow ? target.T_WC : target.Linearized();
  R_WT_ = to.rotation;
  turn_.noalias() = to.rotation.transpose() * from.rotation;
  const Eigen::Vector3d shift = to.rotation.transpose() * (from.translation - to.translation);
  q = turn_ * l.head<2>().homogeneous() + l.z() * shift;
  landmark << turn_.leftCols<2>(), shift;
}

Eigen::Matrix<double, 3, 6> LandmarkTransfer::SourceCamera() const {
  Eigen::Matrix<double, 3, 6> camera;
  camera << -turn_ * Skew(l_.head<2>().homogeneous()), l_.z() * R_WT_.transpose();
  return camera;
}

Eigen::Matrix<double, 3, 6> LandmarkTransfer::TargetCamera() const {
  Eigen::Matrix<double, 3, 6> camera;
  camera << Skew(q), -l_.z() * R_WT_.transpose();
  return camera;
}

Eigen::Matrix<double, 3, 6> LandmarkTransfer::SourceFrame() const {
  return SourceCamera() * source_->camera_from_body;
}

Eigen::Matrix<double, 3, 6> LandmarkTransfer::TargetFrame() const {
  return TargetCamera() * target_->camera_from_body;
}

Eigen::Matrix3Xd LandmarkTransfer::Calibration(const CalibrationLayout& layout) const {
  return SourceCamera() * CalibrationChain(layout, *source_) +
         TargetCamera() * CalibrationChain(layout, *target_);
}

bool LinearizeAnchoredView(const FrameGeometry& anchor, const FrameGeometry& view,
                           const NormalizedObservation& observation, const ObservationKernel& kernel,
                           const Eigen::Vector3d& landmark, AnchoredRows* rows, bool with_frames,
                           const WindowCalibration* calibration) {
  LandmarkTransfer transfer(anchor, view, landmark);
  if (!(transfer.q.z() > kMinViewDepth)) {
    return false;
  }
  rows->residual = observation.sqrt_information * (transfer.q.hnormalized() - observation.z);
  if (with_frames && (anchor.T_WC_first || view.T_WC_first)) {
    transfer = LandmarkTransfer(anchor, view, landmark, LandmarkTransfer::At::kLinearized);
    if (!(transfer.q.z() > kMinViewDepth)) {
      return false;
    }
  }
  const Eigen::Vector2d predicted = transfer.q.hnormalized();
  const Eigen::Matrix<double, 2, 3> weighted =
      observation.sqrt_information * (Perspective(predicted) / transfer.q.z());
  if (with_frames) {
    rows->anchor.noalias() = weighted * transfer.SourceFrame();
    rows->view.noalias() = weighted * transfer.TargetFrame();
  }
  rows->landmark.noalias() = weighted * transfer.landmark;
  rows->squared_norm = rows->residual.squaredNorm();
  rows->weight = RobustWeight(kernel.kernel, kernel.scale_sigma, rows->squared_norm);
  if (with_frames && calibration != nullptr && calibration->size() > 0) {
    const CalibrationLayout& layout = calibration->layout;
    Eigen::MatrixXd intrinsics(2,
                               layout.size());  // the ray's part; the cameras' places come from the transfer
    CalibrationRows(layout, calibration->mean.camera, view.R_WB, nullptr, Eigen::Matrix<double, 2, 6>::Zero(),
                    Predicted(observation, rows->residual), intrinsics);
    rows->calibration = intrinsics + weighted * transfer.Calibration(layout);
  }
  return true;
}

double TrackChiSquare(const WindowTrack& track, std::span<const FrameGeometry> geometry) {
  if (track.anchor == nullptr) {
    return TrackChiSquare(track.views, geometry, track.landmark);
  }
  double chi2 = 0;
  AnchoredRows rows;
  for (const WindowView& view : track.views) {
    if (!LinearizeAnchoredView(geometry[static_cast<size_t>(track.anchor->index)],
                               geometry[static_cast<size_t>(view.frame->index)], view.observation, {},
                               track.landmark, &rows, false)) {
      return std::numeric_limits<double>::infinity();
    }
    chi2 += rows.squared_norm;
  }
  return chi2;
}

bool ChangeAnchor(const FrameGeometry& from, const FrameGeometry& to, const Eigen::Vector3d& l_from,
                  AnchorChange* change, const CalibrationLayout* layout) {
  const Eigen::Vector3d q_to = LandmarkTransfer(from, to, l_from).q;
  if (!(q_to.z() > kMinViewDepth)) {
    return false;
  }
  change->to << q_to.hnormalized(), l_from.z() / q_to.z();
  const LandmarkTransfer back(to, from, change->to, LandmarkTransfer::At::kLinearized);
  Eigen::Matrix3d divide = Eigen::Matrix3d::Zero();
  divide.topRows<2>() = Perspective(l_from.head<2>());
  divide(2, 2) = -l_from.z();
  divide /= back.q.z();
  change->landmark.noalias() = divide * back.landmark;
  change->landmark(2, 2) += 1 / back.q.z();
  change->from_frame.noalias() = divide * back.TargetFrame();
  change->to_frame.noalias() = divide * back.SourceFrame();
  if (layout != nullptr) {
    change->calibration.noalias() = divide * back.Calibration(*layout);
  }
  return true;
}

}  // namespace alidade
