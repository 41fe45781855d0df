#pragma once

#include <Eigen/Core>

namespace alidade {

// The smoother's dense steps that are large enough for a BLAS: Eigen is compiled for any x86-64, OpenBLAS
// takes the kernels of the machine it runs on. Column-major; only lower triangles of symmetric matrices are
// read.

/// gram <- rows^T rows, lower triangle, zero above.
void FormGram(const Eigen::MatrixXd& rows, Eigen::MatrixXd* gram);
/// hessian <- hessian - rows^T rows, lower triangle.
void SubtractGram(const Eigen::MatrixXd& rows, Eigen::MatrixXd* hessian);
/// Replaces the lower triangle by its Cholesky factor L. False: not positive definite.
bool FactorLower(Eigen::MatrixXd* matrix);
/// right <- L^-1 right.
void SolveLower(const Eigen::MatrixXd& lower, Eigen::Ref<Eigen::MatrixXd> right);
/// right <- R^-T right, R the upper triangle.
void SolveUpperTransposed(const Eigen::MatrixXd& upper, Eigen::Ref<Eigen::MatrixXd> right);
/// right <- L^-T L^-1 right.
void SolveCholesky(const Eigen::MatrixXd& lower, Eigen::VectorXd* right);
/// Householder QR in place: the upper triangle becomes R, what is below it has no meaning. Rows in the order
/// of their first entries cost the least: what is zero below the last entry of a panel of columns is skipped.
void Triangularize(Eigen::MatrixXd* rows);

}  // namespace alidade
