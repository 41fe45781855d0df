#include "smoother/solve/window_system.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "smoother/manifold/dense_blas.h"
#include "smoother/solve/row_elimination.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A frame's own columns: its state and, in an aligned window, its clock.
void AddOwn(const WindowFrame& frame, ColumnMap* columns) {
  if (frame.clock) {
    columns->AddClock(frame.index);
  }
  columns->AddState(frame.index);
}

/// Normal equations of several terms as those of one: the rows of its square root are fewer.
LinearTerm Sum(const std::vector<LinearTerm>& terms) {
  LinearTerm sum;
  ColumnMap columns;
  for (const LinearTerm& term : terms) {
    for (const TermPart& part : term.parts) {
      const auto known = std::find_if(sum.parts.begin(), sum.parts.end(), [&](const TermPart& other) {
        return other.of.kind == part.of.kind && other.of.index == part.of.index;
      });
      if (known == sum.parts.end()) {
        sum.parts.push_back(part);
      } else {
        known->width = std::max(known->width, part.width);
      }
    }
  }
  for (TermPart& part : sum.parts) {
    part.first = columns.size();
    columns.Add(part.of, part.width);
  }
  sum.hessian.setZero(columns.size(), columns.size());
  sum.gradient.setZero(columns.size());
  for (const LinearTerm& term : terms) {
    term.AddTo(columns, &sum.hessian, &sum.gradient);
  }
  return sum;
}

Index CalibrationSize(const WindowTerms& terms) {
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    for (const TermPart& part : term->parts()) {
      if (part.of.kind == Unknown::Kind::kCalibration) {
        return part.width;
      }
    }
  }
  return 0;
}

}  // namespace

Eigen::MatrixXd WindowInformation::Whitened(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd whitened = Eigen::MatrixXd::Zero(columns.size(), rows.rows());
  for (Index i = 0; kPoseColumns * i < rows.cols(); ++i) {
    whitened.middleRows<kPoseColumns>(columns.Frame(static_cast<int>(i)).first) =
        rows.middleCols<kPoseColumns>(kPoseColumns * i).transpose();
  }
  SolveUpperTransposed(root, whitened);
  return whitened;
}

bool NewestCovariance(const WindowFrames& frames, const WindowTerms& terms, NewestEstimate* newest,
                      bool calibration_error) {
  // In time order, so that a step touches few columns. The last group is what is asked for: calibration,
  // clock and state of the newest frame.
  ColumnMap columns;
  std::vector<Index> ends;
  for (size_t i = 0; i + 1 < frames.size(); ++i) {
    AddOwn(*frames[i], &columns);
    ends.push_back(columns.size());
  }
  const Index last = columns.size();
  columns.AddCalibration(CalibrationSize(terms));
  AddOwn(*frames.back(), &columns);
  ends.push_back(columns.size());
  RowElimination elimination(columns, calibration_error);
  std::vector<LinearTerm> eliminated;
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    LinearTerm linear;
    if (!term->Linearize(&linear).ok()) {
      return false;
    }
    if (linear.hessian.size() > 0) {
      eliminated.push_back(std::move(linear));
    } else {
      elimination.Add(&linear);
    }
  }
  if (!eliminated.empty()) {
    LinearTerm sum = Sum(eliminated);
    elimination.Add(&sum);
  }
  for (const Index end : ends) {
    if (!elimination.EliminateUpTo(end)) {
      return false;
    }
  }
  const Index size = columns.size() - last;
  const MatrixXd inverse =
      elimination.root().triangularView<Eigen::Upper>().solve(MatrixXd::Identity(size, size));
  const auto root = [&](const ColumnMap::Range& of) -> MatrixXd {
    return inverse.middleRows(of.first - last, of.size);
  };
  const auto covariance = [&](const ColumnMap::Range& of) -> MatrixXd {
    return root(of) * root(of).transpose();
  };
  const ColumnMap::Range state = columns.Frame(frames.back()->index);
  newest->covariance = covariance(state);
  const ColumnMap::Range clock = columns.Clock(frames.back()->index);
  if (clock.size > 0) {
    newest->clock_covariance = covariance(clock);
    newest->clock_state_covariance = root(clock) * root(state).transpose();
  }
  newest->window = {columns, elimination.factor()};
  newest->calibration_deviations = inverse.topRows(columns.Calibration().size).rowwise().norm();
  if (calibration_error) {
    newest->calibration_error = -root(columns.Calibration()) * elimination.residual();
    newest->calibration_state_covariance = root(state) * root(columns.Calibration()).transpose();
  }
  return newest->covariance.allFinite();
}

}  // namespace alidade
