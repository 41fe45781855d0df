#include "smoother/factors/slam_prior_factor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "smoother/tracks/track_system.h"

namespace alidade {
namespace {

// Cost of a point where a landmark lies behind a view, so that the solver refuses the step.
constexpr double kBehindCost = 1e8;

}  // namespace

SlamPriorFactor::SlamPriorFactor(const SlamPrior* prior, int frames)
    : prior_(prior), memo_(std::make_unique<Memo>()) {
  blocks_ = {BlockKind::kNavState, BlockKind::kBias};
  blocks_.resize(static_cast<size_t>(frames) + 1, BlockKind::kNavState);
  if (prior->prior().clock_origin) {
    blocks_.push_back(BlockKind::kClock);
  }
  blocks_.push_back(BlockKind::kCalibration);
  memo_->landmarks = prior->StartingLandmarks();
}

bool SlamPriorFactor::SolveLandmarks(const double* const* parameters) const {
  std::vector<double> values;
  WindowPoint point;
  point.camera = prior_->calibration().mean;
  for (size_t i = 0; i < blocks_.size(); ++i) {
    values.insert(values.end(), parameters[i], parameters[i] + AmbientSize(blocks_[i]));
    if (blocks_[i] == BlockKind::kNavState) {
      point.states.push_back(UnpackNavState(parameters[i]));
    } else if (blocks_[i] == BlockKind::kBias) {
      point.bias = UnpackBias(parameters[i]);
    } else if (blocks_[i] == BlockKind::kClock) {
      point.clock = Eigen::Map<const Vector6d>(parameters[i]);
    } else if (!prior_->calibration().At(parameters[i], &point.camera)) {
      return false;
    }
  }
  if (values == memo_->parameters) {
    return true;
  }
  memo_->parameters = std::move(values);
  memo_->point = std::move(point);
  memo_->linear = false;
  Eigen::VectorXd landmarks = memo_->landmarks;
  memo_->solved = prior_->SolveLandmarks(memo_->point, &landmarks, &memo_->robust_cost);
  if (memo_->solved) {
    memo_->landmarks = std::move(landmarks);
  } else {
    memo_->robust_cost = kBehindCost;
  }
  return true;
}

void SlamPriorFactor::Linearize() const {
  memo_->linear = true;
  SlamPrior::Reduced reduced;
  if (!memo_->solved || !prior_->Linearize(memo_->point, memo_->landmarks, &reduced)) {
    memo_->jacobian.setZero(rows() - 1, rows() - 1);
    memo_->residual.setZero(rows());
    memo_->residual[rows() - 1] = std::sqrt(kBehindCost);
    return;
  }
  Eigen::VectorXd root;
  SquareRootRows(reduced.hessian, reduced.gradient, &memo_->jacobian, &root);
  memo_->residual.resize(rows());
  memo_->residual << root, std::sqrt(std::max(0.0, memo_->robust_cost - root.squaredNorm()));
}

bool SlamPriorFactor::Evaluate(const double* const* parameters, double* residual,
                               double* const* tangent_jacobians) const {
  if (!SolveLandmarks(parameters)) {
    return false;
  }
  Eigen::Map<Eigen::VectorXd> out_residual(residual, rows());
  if (tangent_jacobians == nullptr) {
    out_residual.setZero();
    out_residual[rows() - 1] = std::sqrt(std::max(0.0, memo_->robust_cost));
    return true;
  }
  if (!memo_->linear) {
    Linearize();
  }
  out_residual = memo_->residual;
  const ColumnMap& columns = prior_->columns();
  int frame = 0;
  for (size_t block = 0; block < blocks_.size(); ++block) {
    ColumnMap::Range from = columns.Frame(0);
    switch (blocks_[block]) {
      case BlockKind::kNavState:
        from = columns.Frame(frame++);
        from.size = std::min(from.size, kNavColumns);
        break;
      case BlockKind::kBias:
        from = {from.first + kNavColumns, kBiasColumns};
        break;
      case BlockKind::kClock:
        from = columns.Clock(0);
        break;
      default:
        from = columns.Calibration();
    }
    if (tangent_jacobians[block] == nullptr) {
      continue;
    }
    using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMatrix> out(tangent_jacobians[block], rows(), TangentSize(blocks_[block]));
    out.setZero();
    if (blocks_[block] == BlockKind::kCalibration) {
      out.topLeftCorner(rows() - 1, from.size).noalias() =
          memo_->jacobian.middleCols(from.first, from.size) *
          prior_->calibration().BlockJacobian(parameters[block]);
    } else {
      out.topLeftCorner(rows() - 1, from.size) = memo_->jacobian.middleCols(from.first, from.size);
    }
  }
  return true;
}

}  // namespace alidade
