#include "smoother/solve/window_system.h"

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
  LinearTerm linear;
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    if (!term->Linearize(&linear).ok()) {
      return false;
    }
    elimination.Add(&linear);
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
