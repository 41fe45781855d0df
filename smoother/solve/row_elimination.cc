#include "smoother/solve/row_elimination.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "smoother/manifold/dense_blas.h"

namespace alidade {

RowElimination::RowElimination(ColumnMap columns, bool with_residual)
    : columns_(std::move(columns)), with_residual_(with_residual) {
  rows_.resize(2 * columns_.size(), columns_.size() + (with_residual ? 1 : 0));
  factor_.setZero(columns_.size(), columns_.size());
}

void RowElimination::Add(LinearTerm* term) {
  CHECK(term->chart == LinearTerm::Chart::kCanonical);
  term->MakeRows();
  const Index added = term->jacobian.rows();
  const Index first = count_;
  count_ += added;
  if (count_ > rows_.rows()) {
    rows_.conservativeResize(std::max(count_, 2 * rows_.rows()), Eigen::NoChange);
  }
  auto rows = rows_.middleRows(first, added);
  rows.setZero();
  for (const TermPart& part : term->parts) {
    const ColumnMap::Range at = columns_.Find(part.of);
    CHECK_GE(at.size, part.width) << "a term concerns coordinates without columns";
    rows.middleCols(at.first, part.width) = term->jacobian.middleCols(part.first, part.width);
  }
  if (with_residual_) {
    rows.rightCols<1>() = term->residual;
  }
  for (Index i = first; i < count_; ++i) {
    Index lead = 0;
    while (lead < columns_.size() && rows_(i, lead) == 0) {
      ++lead;
    }
    lead_.push_back(lead);
  }
}

std::vector<RowElimination::Index> RowElimination::ActiveRows(Index end) const {
  std::vector<Index> active;
  for (Index i = 0; i < count_; ++i) {
    if (lead_[static_cast<size_t>(i)] < end) {
      active.push_back(i);
    }
  }
  std::stable_sort(active.begin(), active.end(), [&](Index a, Index b) {
    return lead_[static_cast<size_t>(a)] < lead_[static_cast<size_t>(b)];
  });
  return active;
}

std::vector<RowElimination::Index> RowElimination::TouchedColumns(const std::vector<Index>& active,
                                                                  Index end) const {
  const Index later = columns_.size() - end;
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(later);  // of magnitudes: zero where no row touches
  for (const Index row : active) {
    sum += rows_.row(row).segment(end, later).cwiseAbs();
  }
  std::vector<Index> columns;
  for (Index column = eliminated_; column < columns_.size(); ++column) {
    if (column < end || sum[column - end] != 0) {
      columns.push_back(column);
    }
  }
  return columns;
}

bool RowElimination::EliminateUpTo(Index end) {
  const std::vector<Index> active = ActiveRows(end);
  const std::vector<Index> reached = TouchedColumns(active, end);
  std::vector<Index> touched = reached;
  if (with_residual_) {
    touched.push_back(columns_.size());
  }
  const auto height = static_cast<Index>(active.size());
  const auto width = static_cast<Index>(touched.size());
  const Index group = end - eliminated_;
  if (height < group) {
    return false;
  }
  Eigen::MatrixXd front = rows_(active, touched);
  Triangularize(&front);
  root_ = front.topLeftCorner(group, group).triangularView<Eigen::Upper>();
  if (!root_.allFinite() || (root_.diagonal().array() == 0).any()) {
    return false;
  }
  factor_(Eigen::seqN(eliminated_, group), reached) =
      front.topLeftCorner(group, static_cast<Index>(reached.size())).triangularView<Eigen::Upper>();
  if (with_residual_) {
    residual_ = front.col(width - 1).head(group);
  }
  for (Index i = 0; i < height; ++i) {
    const auto row = static_cast<size_t>(i);
    // The first rows of the triangle are about the group; those below it are zero.
    const bool left = i >= group && i < width;
    lead_[static_cast<size_t>(active[row])] = left ? touched[row] : columns_.size();
    for (Index column = group; left && column < width; ++column) {
      rows_(active[row], touched[static_cast<size_t>(column)]) = column < i ? 0 : front(i, column);
    }
  }
  eliminated_ = end;
  return true;
}

}  // namespace alidade
