#include "core/dense_solvers.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/lie.h"
#include "core/random.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

MatrixXd Drawn(Eigen::Index rows, Eigen::Index cols) {
  RandomStream random(7, "dense_solvers");
  MatrixXd m(rows, cols);
  for (double& value : m.reshaped()) {
    value = random.Normal();
  }
  return m;
}

TEST(DenseSolversTest, AWhitenedCovarianceIsTheIdentity) {
  const Matrix3d root = Drawn(3, 3);
  const Matrix3d covariance = root * root.transpose();
  const Matrix3d whitener = Whitener(covariance);
  EXPECT_LT((whitener * covariance * whitener.transpose() - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_EQ(whitener(0, 1), 0);
}

TEST(DenseSolversTest, OnlyAPositiveMatrixIsPositiveDefinite) {
  EXPECT_TRUE(IsPositiveDefinite(Vector3d(1, 2, 1e-9).asDiagonal()));
  EXPECT_FALSE(IsPositiveDefinite(Vector3d(1, -2, 3).asDiagonal()));
  EXPECT_FALSE(IsPositiveDefinite(Vector3d(1, 0, 3).asDiagonal()));
}

TEST(DenseSolversTest, SolutionsSatisfyTheirEquations) {
  const Matrix3d regular = Drawn(3, 3);
  const Matrix3d symmetric = regular * regular.transpose();
  const Vector3d b(1, -2, 3);
  EXPECT_LT((regular * SolveRegular(regular, b) - b).norm(), 1e-12);
  EXPECT_LT((symmetric * SolveSymmetric(symmetric, b) - b).norm(), 1e-12);

  const MatrixXd rows = Drawn(12, 7);
  const MatrixXd normal = rows.transpose() * rows;
  const SymmetricSolver solver(normal);
  EXPECT_TRUE(solver.positive());
  EXPECT_GT(solver.min_pivot(), 0);
  EXPECT_LT((normal * solver.Solve(MatrixXd::Identity(7, 2)) - MatrixXd::Identity(7, 2)).norm(), 1e-12);
}

TEST(DenseSolversTest, AnIndefiniteMatrixIsNotPositive) {
  const SymmetricSolver solver(Vector3d(1, -1, 2).asDiagonal().toDenseMatrix());
  EXPECT_FALSE(solver.positive());
  EXPECT_EQ(solver.min_pivot(), -1);
}

TEST(DenseSolversTest, TheTriangleKeepsTheInformationOfTheRows) {
  const MatrixXd a = Drawn(9, 4);
  const VectorXd b = Drawn(9, 1);
  VectorXd right = b;
  const MatrixXd triangle = UpperTriangle(a, &right);
  ASSERT_EQ(triangle.rows(), 4);
  EXPECT_EQ(triangle(3, 0), 0);
  EXPECT_LT((triangle.transpose() * triangle - a.transpose() * a).norm(), 1e-12);
  EXPECT_LT((triangle.transpose() * right.head(4) - a.transpose() * b).norm(), 1e-12);
  EXPECT_NEAR(right.norm(), b.norm(), 1e-12);
}

TEST(RotationBetweenTest, TurnsOneDirectionIntoTheOther) {
  for (const Vector3d& to : {Vector3d(1, 2, 3), Vector3d(-2, 0, 0), Vector3d(5, 0, 0)}) {
    const Vector3d from(2, 0, 0);
    const Matrix3d rotation = so3::Between(from, to);
    EXPECT_LT((rotation * from.normalized() - to.normalized()).norm(), 1e-12);
    EXPECT_NEAR(rotation.determinant(), 1, 1e-12);
    // The least one: about the vector across both.
    EXPECT_NEAR(so3::Log(rotation).norm(), std::acos(from.dot(to) / (from.norm() * to.norm())), 1e-7);
  }
}

TEST(RotationBetweenTest, TheNearestRotationOfASumTurnsManyVectorsBest) {
  const Matrix3d turn = so3::Exp(Vector3d(0.3, -0.5, 0.2));
  const MatrixXd from = Drawn(3, 5);
  EXPECT_LT((so3::Normalize(turn * from * from.transpose()) - turn).norm(), 1e-12);
  // Vectors of one plane, which a mirror would turn as well.
  MatrixXd flat = from;
  flat.row(2).setZero();
  EXPECT_LT((so3::Normalize(turn * flat * flat.transpose()) - turn).norm(), 1e-12);
}

}  // namespace
}  // namespace alidade
