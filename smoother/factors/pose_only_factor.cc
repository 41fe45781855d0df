#include "smoother/factors/pose_only_factor.h"

#include <algorithm>
#include <utility>

#include "smoother/tracks/track_landmark.h"

namespace alidade {
namespace {

constexpr int kMaxLandmarkIterations = 30;
// Squared whitened residual of a track whose landmark falls behind a view, so that the solver refuses such a
// step. Not larger: the tolerance of the solver is relative to the whole cost.
constexpr double kBehindChiSquare = 1e4;

}  // namespace

PoseOnlyFactor::PoseOnlyFactor(const Window& window, std::vector<const WindowTrack*> tracks,
                               const WindowCalibration& calibration, const ObservationKernel& kernel)
    : window_(&window),
      frames_(window.size()),
      calibration_(&calibration),
      tracks_(std::move(tracks)),
      kernel_(kernel),
      blocks_(static_cast<size_t>(window.size()), BlockKind::kNavState),
      memo_(std::make_unique<Memo>()) {
  if (calibration.size() > 0) {
    blocks_.push_back(BlockKind::kCalibration);
  }
}

bool PoseOnlyFactor::Linearize(const double* const* parameters) const {
  const double* block = calibration_->Block(parameters, static_cast<size_t>(frames_));
  WindowCalibration camera{calibration_->layout, {}};
  if (!calibration_->At(block, &camera.mean)) {
    return false;
  }
  std::vector<double> point(block, block + calibration_->size());
  std::vector<FrameGeometry> geometry;
  for (int i = 0; i < frames_; ++i) {
    point.insert(point.end(), parameters[i], parameters[i] + kNavAmbientSize);
    geometry.push_back(MakeGeometry(window_->frame(i), UnpackNavState(parameters[i]), camera.mean));
  }
  if (point == memo_->parameters) {
    return true;
  }
  memo_->parameters = std::move(point);
  PoseSystem system(frames_, &camera);
  const bool renormalize = camera.layout.intrinsics() >= 0;
  std::vector<WindowView> renormalized;
  for (const WindowTrack* track : tracks_) {
    if (renormalize) {
      renormalized = Renormalized(camera.mean.camera, track->views);
    }
    const std::vector<WindowView>& views = renormalize ? renormalized : track->views;
    Eigen::Vector3d landmark = track->landmark;
    if (!SolveLandmark(views, geometry, kernel_, kMaxLandmarkIterations, &landmark, track->depth_prior) ||
        !AddTrack(views, geometry, kernel_, landmark, &memo_->workspace, &system, track->depth_prior)) {
      system.robust_cost += kBehindChiSquare;
    }
  }
  Eigen::VectorXd rows;
  SquareRootRows(system.hessian, system.gradient, &memo_->jacobian, &rows);
  memo_->residual.resize(rows.size() + 1);
  memo_->residual << rows, std::sqrt(std::max(0.0, system.robust_cost - rows.squaredNorm()));
  return true;
}

bool PoseOnlyFactor::Evaluate(const double* const* parameters, double* residual,
                              double* const* tangent_jacobians) const {
  if (!Linearize(parameters)) {
    return false;
  }
  Eigen::Map<Eigen::VectorXd>(residual, rows()) = memo_->residual;
  for (int i = 0; tangent_jacobians != nullptr && i < frames_; ++i) {
    if (tangent_jacobians[i] != nullptr) {
      using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, kNavTangentSize, Eigen::RowMajor>;
      Eigen::Map<RowMatrix> out(tangent_jacobians[i], rows(), kNavTangentSize);
      out.setZero();
      out.topLeftCorner(memo_->jacobian.rows(), 6) = memo_->jacobian.middleCols<6>(6 * i);
    }
  }
  if (calibration_->size() > 0 && tangent_jacobians != nullptr && tangent_jacobians[frames_] != nullptr) {
    using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, CalibrationLayout::kMaxSize, Eigen::RowMajor>;
    Eigen::Map<RowMatrix> out(tangent_jacobians[frames_], rows(), CalibrationLayout::kMaxSize);
    out.setZero();
    out.topLeftCorner(memo_->jacobian.rows(), calibration_->size()).noalias() =
        memo_->jacobian.rightCols(calibration_->size()) * calibration_->BlockJacobian(parameters[frames_]);
  }
  return true;
}

}  // namespace alidade
