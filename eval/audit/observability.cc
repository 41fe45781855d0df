#include "eval/audit/observability.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/dense_solvers.h"
#include "filter/filter_state.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int kClock = FilterState::kClockSize;

/// `matrix` without rows [first, first + size).
void EraseRows(Index first, Index size, MatrixXd* matrix) {
  const Index tail = matrix->rows() - first - size;
  matrix->middleRows(first, tail) = matrix->bottomRows(tail).eval();
  matrix->conservativeResize(matrix->rows() - size, Eigen::NoChange);
}

/// What remains of rows once the unknowns of columns [first, first + size) are eliminated; these columns are
/// zero then.
MatrixXd WithoutColumns(Index first, Index size, const MatrixXd& rows) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(rows.middleCols(first, size));
  MatrixXd left = (qr.householderQ().adjoint() * rows).bottomRows(rows.rows() - qr.rank());
  left.middleCols(first, size).setZero();
  return left;
}

/// Orthonormal basis of R^15 whose first four columns span those of `directions`.
Matrix15d BasisWith(const Eigen::Matrix<double, 15, 4>& directions) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(directions);
  return qr.householderQ() * MatrixXd::Identity(15, 15);
}

/// The largest singular value of a matrix of at most 15 x 15.
double LargestSingularValue(const Eigen::Ref<const MatrixXd>& matrix) {
  Matrix15d padded = Matrix15d::Zero();
  padded.topLeftCorner(matrix.rows(), matrix.cols()) = matrix;
  return Eigen::JacobiSVD<Matrix15d>(padded).singularValues()[0];
}

}  // namespace

Eigen::Matrix<double, 15, 4> UnobservableDirections(ErrorConvention convention, const NavState& nav) {
  Eigen::Matrix<double, 15, 4> invariant = Eigen::Matrix<double, 15, 4>::Zero();
  invariant(2, 0) = 1;
  invariant.block<3, 3>(3, 1).setIdentity();
  return InverseImuChartJacobian(convention, nav) *
         (ImuChartJacobian(ErrorConvention::kRightInvariant, nav) * invariant);
}

void ObservabilityAudit::OnReset(const FilterState& state) {
  theory_ = UnobservableDirections(state.convention(), state.nav());
  map_ = Matrix15d::Identity();
  core_ = 0;
  has_clock_ = false;
  landmark_firsts_.clear();
  factor_ = Matrix15d::Zero();
  scale_squared_.setZero();
}

void ObservabilityAudit::OnPropagate(const Matrix15d& phi, const Matrix15d& /*q*/) {
  map_.middleRows<15>(core_) = (phi * map_.middleRows<15>(core_)).eval();
}

void ObservabilityAudit::InsertRows(int first, int size) {
  const Index tail = map_.rows() - first;
  map_.conservativeResize(map_.rows() + size, Eigen::NoChange);
  map_.bottomRows(tail) = map_.middleRows(first, tail).eval();
  map_.middleRows(first, size).setZero();
  core_ += first <= core_ ? size : 0;
  for (int& landmark : landmark_firsts_) {
    landmark += landmark >= first ? size : 0;
  }
}

void ObservabilityAudit::OnClone(int first, int size) {
  InsertRows(core_ + 15, size);
  map_.middleRows(core_ + 15, size) = map_.middleRows(core_ + first, size).eval();
}

void ObservabilityAudit::OnAddLandmark(int first, const MatrixXd& rows) {
  InsertRows(first, 3);
  // The new landmark's columns come first; nothing is known about it yet.
  MatrixXd grown = MatrixXd::Zero(factor_.rows() + 3, factor_.cols() + 3);
  grown.bottomRightCorner(factor_.rows(), factor_.cols()) = factor_;
  factor_ = std::move(grown);
  landmark_firsts_.insert(landmark_firsts_.begin(), first);
  AddRows(rows);
}

void ObservabilityAudit::OnAddToLandmark(int landmark, const Eigen::Matrix3d& m, int source) {
  // f' = f + m s: in the rows, f is f' less m times what s is of the initial error.
  const auto found = std::find(landmark_firsts_.begin(), landmark_firsts_.end(), landmark);
  CHECK(found != landmark_firsts_.end()) << "no landmark starts at row " << landmark;
  const Index column = 3 * (found - landmark_firsts_.begin());
  const Eigen::Matrix<double, 3, 15> shift = m * map_.middleRows<3>(source);
  factor_.rightCols<15>() -= (factor_.middleCols<3>(column) * shift).eval();
}

void ObservabilityAudit::OnRemove(int first, int size) {
  const auto landmark = std::find(landmark_firsts_.begin(), landmark_firsts_.end(), first);
  if (landmark != landmark_firsts_.end()) {
    CHECK_EQ(size, 3) << "a landmark leaves as a whole";
    EliminateLandmark(static_cast<size_t>(landmark - landmark_firsts_.begin()));
  }
  EraseRows(first, size, &map_);
  core_ -= first < core_ ? size : 0;
  for (int& other : landmark_firsts_) {
    other -= other > first ? size : 0;
  }
}

void ObservabilityAudit::EliminateLandmark(size_t index) {
  // With its columns first, the rows below the third no longer mention it.
  const Index column = 3 * static_cast<Index>(index);
  MatrixXd permuted = factor_;
  permuted.leftCols<3>() = factor_.middleCols<3>(column);
  permuted.middleCols(3, column) = factor_.leftCols(column);
  const Index left = factor_.cols() - 3;
  factor_ = UpperTriangle(permuted).bottomRightCorner(left, left).eval();
  landmark_firsts_.erase(landmark_firsts_.begin() + static_cast<std::ptrdiff_t>(index));
}

void ObservabilityAudit::AddRows(const MatrixXd& jacobian) {
  CHECK_EQ(jacobian.cols(), map_.rows());
  const Index columns = factor_.cols();
  MatrixXd stacked(columns + jacobian.rows(), columns);
  stacked.topRows(columns) = factor_;
  auto rows = stacked.bottomRows(jacobian.rows());
  for (size_t i = 0; i < landmark_firsts_.size(); ++i) {
    rows.middleCols<3>(3 * static_cast<Index>(i)) = jacobian.middleCols<3>(landmark_firsts_[i]);
  }
  rows.rightCols<15>().noalias() = jacobian * map_;
  const MatrixXd magnitudes = jacobian.cwiseAbs() * map_.cwiseAbs();
  scale_squared_ += magnitudes.colwise().squaredNorm().transpose();
  factor_ = UpperTriangle(stacked);
}

void ObservabilityAudit::OnAlign(const MatrixXd& turn, bool has_clock) {
  CHECK(landmark_firsts_.empty() && !has_clock_);
  map_ = turn * map_;
  if (has_clock) {
    InsertRows(core_, kClock);
  }
  has_clock_ = has_clock;
}

void ObservabilityAudit::OnShear(const Eigen::VectorXd& column, const Eigen::VectorXd& row) {
  map_ += column * (row.transpose() * map_);
}

void ObservabilityAudit::OnUpdate(const FilterState& /*state*/, const FilterRows& rows) {
  const bool sees_clock = has_clock_ && !rows.jacobian.middleCols<kClock>(core_ - kClock).isZero(0);
  AddRows(sees_clock ? WithoutColumns(core_ - kClock, kClock, rows.jacobian) : rows.jacobian);
}

Vector15d ObservabilityAudit::ColumnScale() const {
  return scale_squared_.cwiseSqrt().unaryExpr([](double scale) { return scale > 0 ? scale : 1.0; });
}

Vector15d ObservabilityAudit::RelativeSingularValues() const {
  const Matrix15d scaled = Factor() * ColumnScale().cwiseInverse().asDiagonal();
  const Vector15d values = Eigen::JacobiSVD<Matrix15d>(scaled).singularValues();
  return values[0] > 0 ? Vector15d(values / values[0]) : Vector15d(Vector15d::Zero());
}

double ObservabilityAudit::YawGain(const Vector15d& scale) const {
  // Yaw last: its diagonal of the triangle is what remains once all other directions have been fitted.
  const Eigen::Matrix<double, 15, 4> scaled_theory = scale.asDiagonal() * theory_;
  Matrix15d basis;
  basis.leftCols<11>() = scale.cwiseInverse().asDiagonal() * BasisWith(scaled_theory).rightCols<11>();
  basis.middleCols<3>(11) = theory_.rightCols<3>();
  basis.col(14) = theory_.col(0);
  const double left = UpperTriangle(Factor() * basis)(14, 14);
  return left * left;
}

void ObservabilityAudit::OnFrame(const FilterState& state) {
  ObservabilityRecord record;
  record.stamp_ns = state.stamp_ns();
  const Matrix15d factor = Factor();
  const Vector15d scale = ColumnScale();
  const Matrix15d scaled = factor * scale.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Matrix15d> svd(scaled, Eigen::ComputeFullV);
  const Vector15d& values = svd.singularValues();
  record.rank = static_cast<int>((values.array() > kObservabilityTolerance * values[0]).count());
  const Eigen::Matrix<double, 15, 4> leaks = factor * theory_;
  record.yaw_leak = leaks.col(0).squaredNorm();
  record.position_leak = std::pow(LargestSingularValue(leaks.rightCols<3>()), 2);
  record.yaw_gain = YawGain(scale);
  // Sine of the largest principal angle: the part of the weakest directions outside of theory.
  const Matrix15d basis = BasisWith(scale.asDiagonal() * theory_);
  const Eigen::Matrix<double, 11, 4> outside =
      basis.rightCols<11>().transpose() * svd.matrixV().rightCols<4>();
  record.null_angle_rad = std::asin(std::min(1.0, LargestSingularValue(outside)));
  records_.push_back(record);
}

}  // namespace alidade
