#include "smoother/solve/window_term.h"

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "smoother/tracks/track_system.h"

namespace alidade {
namespace {

using Eigen::Index;

Index ColumnsOf(const std::vector<TermPart>& parts) {
  return parts.empty() ? 0 : parts.back().first + parts.back().width;
}

}  // namespace

void LinearTerm::ResizeRows(const std::vector<TermPart>& of, Index rows) {
  chart = Chart::kCanonical;
  parts = of;
  jacobian.setZero(rows, ColumnsOf(of));
  residual.setZero(rows);
  hessian.resize(0, 0);
  gradient.resize(0);
}

void LinearTerm::SetInformation(const std::vector<TermPart>& of, NormalEquations equations) {
  chart = Chart::kCanonical;
  parts = of;
  hessian = std::move(equations.hessian);
  gradient = std::move(equations.gradient);
}

void LinearTerm::MakeRows() {
  if (hessian.size() > 0) {
    SquareRootRows(hessian, gradient, &jacobian, &residual);
    hessian.resize(0, 0);
  }
}

void LinearTerm::AddTo(const ColumnMap& columns, Eigen::MatrixXd* total, Eigen::VectorXd* slope) const {
  CHECK(chart == Chart::kCanonical);
  const bool information = hessian.size() > 0;
  std::vector<ColumnMap::Range> at;
  for (const TermPart& part : parts) {
    at.push_back(columns.Find(part.of));
    at.back().size = std::min(at.back().size, part.width);
    const Index dropped = part.width - at.back().size;
    CHECK(dropped == 0 ||
          (!information && jacobian.middleCols(part.first + at.back().size, dropped).isZero(0)))
        << "a term concerns coordinates without columns";
  }
  for (size_t a = 0; a < parts.size(); ++a) {
    if (information) {
      slope->segment(at[a].first, at[a].size) += gradient.segment(parts[a].first, at[a].size);
    } else {
      slope->segment(at[a].first, at[a].size).noalias() +=
          jacobian.middleCols(parts[a].first, at[a].size).transpose() * residual;
    }
    for (size_t b = 0; b <= a; ++b) {
      const bool swap = at[b].first > at[a].first;  // of the total, the lower triangle counts
      const size_t low = swap ? b : a;
      const size_t high = swap ? a : b;
      auto block = total->block(at[low].first, at[high].first, at[low].size, at[high].size);
      if (!information) {
        block.noalias() += jacobian.middleCols(parts[low].first, at[low].size).transpose() *
                           jacobian.middleCols(parts[high].first, at[high].size);
      } else if (swap) {
        block += hessian.block(parts[a].first, parts[b].first, at[a].size, at[b].size).transpose();
      } else {
        block += hessian.block(parts[a].first, parts[b].first, at[a].size, at[b].size);
      }
    }
  }
}

void InformationTerm::AddPart(const Unknown& of, Index width) {
  if (width > 0) {
    parts_.push_back({of, columns(), width});
  }
}

Index InformationTerm::columns() const {
  return ColumnsOf(parts_);
}

}  // namespace alidade
