#include "smoother/solve/marginal_stack.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>
#include <utility>

#include "core/check.h"
#include "smoother/manifold/dense_blas.h"

namespace alidade {

namespace {

constexpr double kRegularization = 1e-5;  // of a column's norm

}  // namespace

Matrix6d PosePriorChart(const StateChart& chart, const WindowFrame& frame) {
  if (frame.first) {
    return StatePriorChart(chart, frame).topLeftCorner<6, 6>();
  }
  return ChartJacobian(chart.convention, chart.FromCentre(frame.nav_state().T_WB()));
}

Matrix15d StatePriorChart(const StateChart& chart, const WindowFrame& frame) {
  const NavState state = frame.nav_state();
  Matrix15d jacobian = ImuChartJacobian(chart.convention, chart.FromCentre(state));
  if (frame.first) {
    // The columns are the prior's coordinates, around the first estimate.
    const Matrix9d moved = chart.LocalJacobian(frame.first->Point(state), state);
    jacobian.topLeftCorner<9, 9>() = (jacobian.topLeftCorner<9, 9>() * moved.inverse()).eval();
  }
  return jacobian;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> SpreadPriorSlope(const LinearPrior& prior,
                                                          const LinearPrior::SpreadChange& change,
                                                          const StateChart& chart) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> slope = change.slope;
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    slope.col(static_cast<Eigen::Index>(i))
        .applyOnTheLeft(PosePriorChart(chart, *prior.anchors[i].frame).transpose());
  }
  return slope;
}

MarginalStack::MarginalStack(const Window& window, const StateChart& chart, ColumnMap columns, Index leaving)
    : window_(window), chart_(chart), columns_(std::move(columns)), leaving_(leaving) {
  stack_.resize(2 * columns_.size(), columns_.size() + 1);
}

MarginalStack::Index MarginalStack::NewRows(Index count) {
  const Index first = rows_;
  rows_ += count;
  if (rows_ > stack_.rows()) {
    stack_.conservativeResize(std::max(rows_, 2 * stack_.rows()), columns_.size() + 1);
  }
  stack_.middleRows(first, count).setZero();
  return first;
}

void MarginalStack::Add(LinearTerm* term) {
  term->MakeRows();
  const Index count = term->residual.size();
  const Index first = NewRows(count);
  for (const TermPart& part : term->parts) {
    const ColumnMap::Range at = columns_.Find(part.of);
    CHECK_GE(at.size, part.width) << "a term concerns coordinates that the next prior cannot hold";
    auto block = stack_.block(first, at.first, count, part.width);
    if (part.of.kind != Unknown::Kind::kFrame || term->chart == LinearTerm::Chart::kPrior) {
      block = term->jacobian.middleCols(part.first, part.width);
      continue;
    }
    const WindowFrame& frame = window_.frame(part.of.index);
    if (part.width != kPoseColumns) {
      block.noalias() = term->jacobian.middleCols(part.first, part.width) *
                        StatePriorChart(chart_, frame).topLeftCorner(part.width, part.width);
    } else if (count == 2) {  // a view: of fixed size, its rounding does not depend on where the block lies
      const Eigen::Matrix<double, 2, 6> view = term->jacobian.middleCols<kPoseColumns>(part.first);
      block = Eigen::Matrix<double, 2, 6>(view * PosePriorChart(chart_, frame));
    } else {
      block.noalias() = term->jacobian.middleCols<kPoseColumns>(part.first) * PosePriorChart(chart_, frame);
    }
  }
  stack_.col(columns_.size()).segment(first, count) = term->residual;
}

void MarginalStack::MakeRegular(const ColumnMap::Range& of) {
  const Eigen::RowVectorXd norms = stack_.middleCols(of.first, of.size).topRows(rows_).colwise().norm();
  const Index first = NewRows(of.size);
  stack_.block(first, of.first, of.size, of.size).diagonal() = kRegularization * norms;
}

bool MarginalStack::IsEmpty(Index column) const {
  return stack_.col(column).head(rows_).isZero(0);
}

Eigen::MatrixXd MarginalStack::Staircase() const {
  const Index width = columns_.size() + 1;
  std::vector<Index> order;
  std::vector<Index> left(static_cast<size_t>(rows_));
  std::iota(left.begin(), left.end(), 0);
  for (Index column = 0; column < width && !left.empty(); ++column) {
    const auto rest =
        std::stable_partition(left.begin(), left.end(), [&](Index row) { return stack_(row, column) == 0; });
    for (auto row = rest; row != left.end(); ++row) {
      auto place = static_cast<Index>(order.size());
      while (place < column || (place < width && IsEmpty(place))) {
        order.push_back(-1);
        ++place;
      }
      order.push_back(*row);
    }
    left.erase(rest, left.end());
  }
  order.resize(std::max(order.size(), static_cast<size_t>(width)), -1);
  Eigen::MatrixXd rows(static_cast<Index>(order.size()), width);
  for (Index column = 0; column < width; ++column) {
    for (size_t i = 0; i < order.size(); ++i) {
      rows(static_cast<Index>(i), column) = order[i] < 0 ? 0 : stack_(order[i], column);
    }
  }
  return rows;
}

void MarginalStack::Eliminate(Eigen::MatrixXd* jacobian, Eigen::VectorXd* residual) {
  const Index columns = columns_.size();
  Eigen::MatrixXd rows = Staircase();
  Triangularize(&rows);
  const Index kept = columns - leaving_;
  *jacobian = rows.block(leaving_, leaving_, kept, kept).triangularView<Eigen::Upper>();
  *residual = rows.col(columns).segment(leaving_, kept);
}

}  // namespace alidade
