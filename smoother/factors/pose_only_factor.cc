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
  blocks_.push_back(BlockKind::kCalibration);
}

bool PoseOnlyFactor::SolveLandmarks(const double* const* parameters) const {
  const double* block = parameters[frames_];
  WindowCalibration camera{calibration_->layout, {}};
  if (!calibration_->At(block, &camera.mean)) {
    return false;
  }
  std::vector<double> point(block, block + calibration_->size());
  for (int i = 0; i < frames_; ++i) {
    point.insert(point.end(), parameters[i], parameters[i] + kNavAmbientSize);
  }
  Memo& memo = *memo_;
  if (point == memo.parameters) {
    return true;
  }
  memo.parameters = std::move(point);
  memo.linear = false;
  memo.camera = camera;
  memo.geometry.clear();
  for (int i = 0; i < frames_; ++i) {
    memo.geometry.push_back(MakeGeometry(window_->frame(i), UnpackNavState(parameters[i]), camera.mean));
  }
  memo.landmarks.assign(tracks_.size(), std::nullopt);
  memo.robust_cost = 0;
  std::vector<WindowView> renormalized;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    const WindowTrack& track = *tracks_[i];
    Eigen::Vector3d landmark = track.landmark;
    double cost = 0;
    if (SolveLandmark(Renormalized(camera, track.views, &renormalized), memo.geometry, kernel_,
                      kMaxLandmarkIterations, &landmark, track.depth_prior, &cost)) {
      memo.landmarks[i] = landmark;
    } else {
      cost = kBehindChiSquare;
    }
    memo.robust_cost += cost;
  }
  return true;
}

void PoseOnlyFactor::Linearize() const {
  Memo& memo = *memo_;
  PoseSystem system(frames_, &memo.camera);
  memo.columns = system.columns;
  std::vector<WindowView> renormalized;
  for (size_t i = 0; i < tracks_.size(); ++i) {
    if (memo.landmarks[i]) {  // a landmark that its views do not determine gives no rows
      AddTrack(Renormalized(memo.camera, tracks_[i]->views, &renormalized), memo.geometry, kernel_,
               *memo.landmarks[i], &memo.workspace, &system, tracks_[i]->depth_prior);
    }
  }
  Eigen::VectorXd rows;
  SquareRootRows(system.hessian, system.gradient, &memo.jacobian, &rows);
  memo.residual.resize(rows.size() + 1);
  memo.residual << rows, std::sqrt(std::max(0.0, memo.robust_cost - rows.squaredNorm()));
  memo.linear = true;
}

bool PoseOnlyFactor::Evaluate(const double* const* parameters, double* residual,
                              double* const* tangent_jacobians) const {
  if (!SolveLandmarks(parameters)) {
    return false;
  }
  Eigen::Map<Eigen::VectorXd> out_residual(residual, rows());
  if (tangent_jacobians == nullptr) {
    out_residual.setZero();
    out_residual[rows() - 1] = std::sqrt(memo_->robust_cost);
    return true;
  }
  if (!memo_->linear) {
    Linearize();
  }
  out_residual = memo_->residual;
  for (int i = 0; i < frames_; ++i) {
    if (tangent_jacobians[i] != nullptr) {
      using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, kNavTangentSize, Eigen::RowMajor>;
      Eigen::Map<RowMatrix> out(tangent_jacobians[i], rows(), kNavTangentSize);
      out.setZero();
      out.topLeftCorner(memo_->jacobian.rows(), 6) =
          memo_->jacobian.middleCols<kPoseColumns>(memo_->columns.Frame(i).first);
    }
  }
  if (tangent_jacobians[frames_] != nullptr) {
    using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, CalibrationLayout::kMaxSize, Eigen::RowMajor>;
    Eigen::Map<RowMatrix> out(tangent_jacobians[frames_], rows(), CalibrationLayout::kMaxSize);
    out.setZero();
    out.topLeftCorner(memo_->jacobian.rows(), calibration_->size()).noalias() =
        memo_->jacobian.rightCols(calibration_->size()) * calibration_->BlockJacobian(parameters[frames_]);
  }
  return true;
}

}  // namespace alidade
