#include "smoother/solve/window_system.h"

#include <Eigen/Cholesky>

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Calibration, clocks, states: the newest state comes last.
ColumnMap ColumnsOf(const WindowFrames& frames, const WindowTerms& terms) {
  const Unknown calibration{Unknown::Kind::kCalibration, 0};
  Index width = 0;
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    for (const TermPart& part : term->parts()) {
      width = part.of.kind == calibration.kind ? part.width : width;
    }
  }
  ColumnMap columns;
  columns.Add(calibration, width);
  for (const std::unique_ptr<WindowFrame>& frame : frames) {
    if (frame->clock) {
      columns.AddClock(frame->index);
    }
  }
  for (const std::unique_ptr<WindowFrame>& frame : frames) {
    columns.AddState(frame->index);
  }
  return columns;
}

}  // namespace

bool NewestCovariance(const WindowFrames& frames, const WindowTerms& terms, NewestEstimate* newest) {
  const ColumnMap columns = ColumnsOf(frames, terms);
  MatrixXd hessian = MatrixXd::Zero(columns.size(), columns.size());
  VectorXd gradient = VectorXd::Zero(columns.size());
  LinearTerm linear;
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    if (!term->Linearize(&linear).ok()) {
      return false;
    }
    linear.AddTo(columns, &hessian, &gradient);
  }
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(hessian);
  if (factor.info() != Eigen::Success) {
    return false;
  }
  // The newest frame comes last, so its own corner of the factor holds its marginal information.
  const Matrix15d corner = hessian.bottomRightCorner<15, 15>().triangularView<Eigen::Lower>();
  const Matrix15d inverse = corner.triangularView<Eigen::Lower>().solve(Matrix15d::Identity());
  newest->covariance = inverse.transpose() * inverse;
  const ColumnMap::Range clock = columns.Clock(frames.back()->index);
  if (clock.size > 0) {
    MatrixXd unit = MatrixXd::Zero(hessian.rows(), clock.size);
    unit.middleRows<kClockColumns>(clock.first).setIdentity();
    newest->clock_covariance = MatrixXd(factor.solve(unit)).middleRows<kClockColumns>(clock.first);
  }
  const MatrixXd unit = MatrixXd::Identity(hessian.rows(), columns.Calibration().size);
  newest->calibration_deviations = MatrixXd(factor.solve(unit)).diagonal().cwiseSqrt();
  return newest->covariance.allFinite();
}

}  // namespace alidade
