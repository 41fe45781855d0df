#include "smoother/solve/reduced_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "smoother/factors/prior_factor.h"
#include "smoother/solve/parameter_blocks.h"
#include "smoother/tracks/track_system.h"

namespace alidade {
namespace {

using Eigen::Index;

constexpr int kFramesOfAGroup = 4;

}  // namespace

class ReducedRows::Rows {
 public:
  static constexpr int kRows = Eigen::Dynamic;

  /// `count` rows from `first` on, which concern the frames from `frame` on. `last`: and the row with the
  /// rest of the cost.
  Rows(const ReducedRows* all, Index first, Index count, int frame, bool last)
      : all_(all), first_(first), count_(count), last_(last) {
    const ColumnMap& columns = all->columns_;
    const auto add = [&](BlockKind kind, int index, const ColumnMap::Range& of) {
      blocks_.push_back(kind);
      columns_.push_back(of);
      parameters_.push_back(all->blocks_->Find(kind, index));
    };
    for (int i = frame; i < all->blocks_->frames(); ++i) {
      const ColumnMap::Range state = columns.Frame(i);
      add(BlockKind::kNavState, i, {state.first, std::min(state.size, kNavColumns)});
      if (state.size > kNavColumns) {
        add(BlockKind::kBias, i, {state.first + kNavColumns, kBiasColumns});
      }
    }
    if (columns.Clock(0).size > 0) {
      add(BlockKind::kClock, 0, columns.Clock(0));
    }
    add(BlockKind::kCalibration, 0, columns.Calibration());
  }

  [[nodiscard]] int rows() const { return static_cast<int>(count_) + (last_ ? 1 : 0); }
  [[nodiscard]] std::span<const BlockKind> blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<double*>& parameters() const { return parameters_; }

  bool Evaluate(const double* const* parameters, double* residual, double* const* tangent_jacobians) const {
    if (!all_->valid_) {
      return false;
    }
    Eigen::Map<Eigen::VectorXd> out_residual(residual, rows());
    if (tangent_jacobians == nullptr) {
      out_residual.setZero();
      if (last_) {
        out_residual[count_] = std::sqrt(std::max(0.0, all_->total_));
      }
      return true;
    }
    out_residual = all_->residual_.segment(first_, rows());
    for (size_t block = 0; block < blocks_.size(); ++block) {
      if (tangent_jacobians[block] == nullptr) {
        continue;
      }
      using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMatrix> out(tangent_jacobians[block], rows(), TangentSize(blocks_[block]));
      const ColumnMap::Range& from = columns_[block];
      const auto own = all_->jacobian_.block(first_, from.first, count_, from.size);
      out.setZero();
      if (blocks_[block] == BlockKind::kCalibration) {
        out.topLeftCorner(count_, from.size).noalias() =
            own * all_->blocks_->calibration().BlockJacobian(parameters[block]);
      } else {
        out.topLeftCorner(count_, from.size) = own;
      }
    }
    return true;
  }

 private:
  const ReducedRows* all_;
  Index first_;
  Index count_;
  bool last_;
  std::vector<BlockKind> blocks_;
  std::vector<ColumnMap::Range> columns_;  ///< of each block
  std::vector<double*> parameters_;
};

ReducedRows::ReducedRows(ParameterBlocks* blocks) : blocks_(blocks) {}
ReducedRows::~ReducedRows() = default;

void ReducedRows::Add(ReducedCost* cost, const std::vector<TermPart>& parts, ceres::Problem* problem) {
  parameters_.clear();
  if (rows_.empty()) {
    columns_ = PriorColumns(blocks_->frames(), blocks_->has_clocks(), blocks_->calibration().size());
    AddRows(problem);
  }
  costs_.push_back({cost, parts});
  std::erase_if(costs_.back().parts, [&](const TermPart& part) {
    return part.of.kind == Unknown::Kind::kCalibration && columns_.Calibration().size == 0;
  });
}

void ReducedRows::AddRows(ceres::Problem* problem) {
  for (int frame = 0; frame < blocks_->frames(); frame += kFramesOfAGroup) {
    const bool last = frame + kFramesOfAGroup >= blocks_->frames();
    const Index first = columns_.Frame(frame).first;
    const Index end = last ? columns_.size() : columns_.Frame(frame + kFramesOfAGroup).first;
    const Rows rows(this, first, end - first, frame, last);
    rows_.push_back(std::make_unique<LiftedCost<Rows>>(rows));
    problem->AddResidualBlock(rows_.back().get(), nullptr, rows.parameters());
  }
}

void ReducedRows::PrepareForEvaluation(bool evaluate_jacobians, bool /*new_evaluation_point*/) {
  if (costs_.empty()) {
    return;
  }
  if (parameters_ != blocks_->values()) {
    parameters_ = blocks_->values();
    linear_ = false;
    Solve();
  }
  if (evaluate_jacobians && valid_ && !linear_) {
    Linearize();
  }
}

void ReducedRows::Solve() {
  WindowPoint point;
  valid_ = blocks_->PointAt(&point);
  total_ = 0;
  for (size_t i = 0; valid_ && i < costs_.size(); ++i) {
    total_ += costs_[i].cost->Solve(point);
  }
}

void ReducedRows::Linearize() {
  NormalEquations all{Eigen::MatrixXd::Zero(columns_.size(), columns_.size()),
                      Eigen::VectorXd::Zero(columns_.size())};
  double total = total_;
  for (const Cost& each : costs_) {
    NormalEquations own;
    if (each.cost->Linearize(&own)) {
      LinearTerm linear;
      linear.SetInformation(each.parts, std::move(own));
      linear.AddTo(columns_, &all.hessian, &all.gradient);
    } else {
      total = std::max(total, ReducedCost::kRefused);
    }
  }
  Eigen::VectorXd rows;
  SquareRootRows(all.hessian, all.gradient, &jacobian_, &rows);
  residual_.resize(rows.size() + 1);
  residual_ << rows, std::sqrt(std::max(0.0, total - rows.squaredNorm()));
  linear_ = true;
}

}  // namespace alidade
