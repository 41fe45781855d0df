#include "core/dense_solvers.h"

#include <Eigen/LU>
#include <Eigen/QR>

#include "core/numbers.h"

namespace alidade {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

Matrix3d Whitener(const Matrix3d& covariance) {
  return covariance.llt().matrixL().solve(Matrix3d::Identity());
}

bool IsPositiveDefinite(const Matrix3d& matrix) {
  return matrix.llt().info() == Eigen::Success;
}

Vector3d SolveSymmetric(const Matrix3d& a, const Vector3d& b) {
  return a.ldlt().solve(b);
}

Vector3d SolveRegular(const Matrix3d& a, const Vector3d& b) {
  return a.partialPivLu().solve(b);
}

SymmetricSolver::SymmetricSolver(const Eigen::Ref<const MatrixXd>& matrix) : factor_(matrix) {}

bool SymmetricSolver::positive() const {
  return factor_.info() == Eigen::Success && factor_.isPositive();
}

double SymmetricSolver::min_pivot() const {
  return factor_.info() == Eigen::Success ? factor_.vectorD().minCoeff() : kNan;
}

MatrixXd SymmetricSolver::Solve(const Eigen::Ref<const MatrixXd>& b) const {
  return factor_.solve(b);
}

MatrixXd UpperTriangle(const MatrixXd& a, Eigen::VectorXd* right) {
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  if (right != nullptr) {
    right->applyOnTheLeft(qr.householderQ().adjoint());
  }
  return qr.matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

}  // namespace alidade
