#include "smoother/pose_only_factor.h"

#include <algorithm>
#include <utility>

namespace alidade {
namespace {

constexpr int kMaxLandmarkIterations = 30;
// Squared whitened residual of a track whose landmark falls behind a view, so that the solver refuses such a
// step. Not larger: the tolerance of the solver is relative to the whole cost.
constexpr double kBehindChiSquare = 1e4;

}  // namespace

PoseOnlyFactor::PoseOnlyFactor(int frames, std::vector<const WindowTrack*> tracks, const Pose& T_BC,
                               const ObservationKernel& kernel)
    : frames_(frames),
      tracks_(std::move(tracks)),
      T_BC_(T_BC),
      kernel_(kernel),
      blocks_(static_cast<size_t>(frames), BlockKind::kNavState),
      memo_(std::make_unique<Memo>()) {}

void PoseOnlyFactor::Linearize(const double* const* parameters) const {
  std::vector<double> point;
  std::vector<FrameGeometry> geometry;
  for (int i = 0; i < frames_; ++i) {
    point.insert(point.end(), parameters[i], parameters[i] + kNavAmbientSize);
    geometry.push_back(MakeGeometry(UnpackNavState(parameters[i]), T_BC_));
  }
  if (point == memo_->parameters) {
    return;
  }
  memo_->parameters = std::move(point);
  PoseSystem system(frames_);
  for (const WindowTrack* track : tracks_) {
    Eigen::Vector3d landmark = track->landmark;
    if (!SolveLandmark(track->views, geometry, kernel_, kMaxLandmarkIterations, &landmark,
                       track->depth_prior) ||
        !AddTrack(track->views, geometry, kernel_, landmark, &memo_->workspace, &system,
                  track->depth_prior)) {
      system.robust_cost += kBehindChiSquare;
    }
  }
  Eigen::VectorXd rows;
  SquareRootRows(system.hessian, system.gradient, &memo_->jacobian, &rows);
  memo_->residual.resize(rows.size() + 1);
  memo_->residual << rows, std::sqrt(std::max(0.0, system.robust_cost - rows.squaredNorm()));
}

bool PoseOnlyFactor::Evaluate(const double* const* parameters, double* residual,
                              double* const* tangent_jacobians) const {
  Linearize(parameters);
  Eigen::Map<Eigen::VectorXd>(residual, rows()) = memo_->residual;
  for (int i = 0; tangent_jacobians != nullptr && i < frames_; ++i) {
    if (tangent_jacobians[i] != nullptr) {
      using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, kNavTangentSize, Eigen::RowMajor>;
      Eigen::Map<RowMatrix> out(tangent_jacobians[i], rows(), kNavTangentSize);
      out.setZero();
      out.topLeftCorner(6 * frames_, 6) = memo_->jacobian.middleCols<6>(6 * i);
    }
  }
  return true;
}

}  // namespace alidade
