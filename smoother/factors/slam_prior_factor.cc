#include "smoother/factors/slam_prior_factor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "smoother/factors/imu_factor.h"

namespace alidade {
namespace {

// Cost of a point where a landmark lies behind a view, so that the solver refuses the step.
constexpr double kBehindCost = 1e8;

}  // namespace

SlamPriorFactor::SlamPriorFactor(const SlamPrior* prior, int frames)
    : prior_(prior), frames_(frames), memo_(std::make_unique<Memo>()) {
  blocks_ = {BlockKind::kNavState, BlockKind::kBias};
  blocks_.resize(static_cast<size_t>(frames) + 1, BlockKind::kNavState);
  if (prior->prior().clock_origin) {
    blocks_.push_back(BlockKind::kClock);
  }
  if (prior->calibration() != nullptr) {
    blocks_.push_back(BlockKind::kCalibration);
  }
  memo_->landmarks = prior->StartingLandmarks();
}

bool SlamPriorFactor::Linearize(const double* const* parameters) const {
  std::vector<double> values;
  WindowPoint point;
  for (size_t i = 0; i < blocks_.size(); ++i) {
    values.insert(values.end(), parameters[i], parameters[i] + AmbientSize(blocks_[i]));
    if (blocks_[i] == BlockKind::kNavState) {
      point.states.push_back(UnpackNavState(parameters[i]));
    } else if (blocks_[i] == BlockKind::kBias) {
      point.bias = UnpackBias(parameters[i]);
    } else if (blocks_[i] == BlockKind::kClock) {
      point.clock = Eigen::Map<const Vector6d>(parameters[i]);
    } else if (!prior_->calibration()->At(parameters[i], &point.camera)) {
      return false;
    }
  }
  if (values == memo_->parameters) {
    return true;
  }
  memo_->parameters = std::move(values);
  SlamPrior::Reduced reduced;
  Eigen::VectorXd landmarks = memo_->landmarks;
  if (!prior_->Reduce(point, &landmarks, &reduced)) {
    memo_->jacobian.setZero(prior_->columns(), prior_->columns());
    memo_->residual.setConstant(rows(), std::sqrt(kBehindCost));
    return true;
  }
  memo_->landmarks = std::move(landmarks);
  Eigen::VectorXd root;
  SquareRootRows(reduced.hessian, reduced.gradient, &memo_->jacobian, &root);
  memo_->residual.resize(rows());
  memo_->residual << root, std::sqrt(std::max(0.0, reduced.robust_cost - root.squaredNorm()));
  return true;
}

bool SlamPriorFactor::Evaluate(const double* const* parameters, double* residual,
                               double* const* tangent_jacobians) const {
  if (!Linearize(parameters)) {
    return false;
  }
  Eigen::Map<Eigen::VectorXd>(residual, rows()) = memo_->residual;
  const auto write = [&](size_t block, Eigen::Index from, Eigen::Index width) {
    if (tangent_jacobians == nullptr || tangent_jacobians[block] == nullptr) {
      return;
    }
    using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMatrix> out(tangent_jacobians[block], rows(), TangentSize(blocks_[block]));
    out.setZero();
    out.topLeftCorner(rows() - 1, width) = memo_->jacobian.middleCols(from, width);
  };
  write(0, 0, 9);
  write(1, 9, 6);
  for (int i = 1; i < frames_; ++i) {
    write(static_cast<size_t>(i) + 1, SlamPrior::Column(i), 6);
  }
  const size_t clock = static_cast<size_t>(frames_) + 1;
  if (prior_->prior().clock_origin) {
    write(clock, SlamPrior::Column(frames_), 6);
  }
  const size_t last = blocks_.size() - 1;
  if (blocks_[last] == BlockKind::kCalibration && tangent_jacobians != nullptr &&
      tangent_jacobians[last] != nullptr) {
    using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, CalibrationLayout::kMaxSize, Eigen::RowMajor>;
    Eigen::Map<RowMatrix> out(tangent_jacobians[last], rows(), CalibrationLayout::kMaxSize);
    const int size = prior_->calibration()->size();
    out.setZero();
    out.topLeftCorner(rows() - 1, size).noalias() =
        memo_->jacobian.rightCols(size) * prior_->calibration()->BlockJacobian(parameters[last]);
  }
  return true;
}

}  // namespace alidade
