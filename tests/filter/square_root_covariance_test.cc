#include "filter/square_root_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/random.h"
#include "tests/filter/square_root_fixture.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::RandomMatrix;
using test::SquareRootCovarianceTest;

TEST_F(SquareRootCovarianceTest, FollowsTheDenseCovarianceThroughAWindow) {
  for (int frame = 0; frame < 25; ++frame) {
    Propagate();
    ExpectEqual();
    Clone();
    ExpectEqual();
    if (root_.dimension() == 15 + 6 * 8) {
      const int clones = (root_.dimension() - 15) / 6;
      Remove(15 + 6 * (frame % clones));  // oldest, newest and between
      ExpectEqual();
    }
  }
}

TEST_F(SquareRootCovarianceTest, FollowsTheDenseCovarianceWithLeadingBlocks) {
  Clone();
  for (int frame = 0; frame < 40; ++frame) {
    Propagate();
    ExpectEqual();
    Clone();
    ExpectEqual();
    AddLeading();
    ExpectEqual();
    const int last_clone = static_cast<int>(dense_.rows()) - 6;
    AddToLeading(3 * (frame % (leading_ / 3)), last_clone);
    ExpectEqual();
    if (leading_ == 12) {
      Remove(3 * (frame % 4), 3);  // newest, between and oldest
      ExpectEqual();
    }
    if (dense_.rows() - leading_ == 15 + 6 * 8) {
      Remove(leading_ + 15 + 6 * (frame % 8));
      ExpectEqual();
    }
    Update(frame % 2 == 0 ? leading_ : 0, frame % 3 == 0 ? 0 : 20);
    ExpectEqual();
  }
}

TEST_F(SquareRootCovarianceTest, AShearIsThatOfTheCovariance) {
  for (int round = 0; round < 3; ++round) {
    Shear();
    ExpectEqual();
    Clone();
    AddLeading();
    Shear();
    ExpectEqual();
    Update();
    ExpectEqual();
  }
}

TEST_F(SquareRootCovarianceTest, UpdateIsTheKalmanUpdate) {
  for (int frame = 0; frame < 5; ++frame) {
    Propagate();
    Clone();
  }
  for (const int unseen : {21, 0}) {
    Update(unseen);
    ExpectEqual();
  }
}

TEST_F(SquareRootCovarianceTest, UpdateByBlockIsTheKalmanUpdate) {
  for (int frame = 0; frame < 8; ++frame) {
    Propagate();
    Clone();
  }
  AddLeading();
  AddLeading();
  for (const int count : {1, 7, 21}) {
    UpdateByBlock(0, root_.dimension(), count);
    ExpectEqual();
    UpdateByBlock(leading_, 15, count);
    ExpectEqual();
    UpdateByBlock(root_.dimension() - 6, 6, count);
    ExpectEqual();
    UpdateByBlock(leading_, 15, count, 3);
    ExpectEqual();
  }
}

TEST_F(SquareRootCovarianceTest, UpdateByBlockRefusesRowsThatAreNotFinite) {
  Clone();
  const MatrixXd before = root_.Covariance();
  MatrixXd rows = MatrixXd::Ones(3, 15);
  rows(1, 2) = std::nan("");
  VectorXd correction(root_.dimension());
  EXPECT_FALSE(root_.UpdateByBlock(0, rows, VectorXd::Zero(3), correction, nullptr));
  rows(1, 2) = 1;
  EXPECT_FALSE(root_.UpdateByBlock(0, rows, VectorXd::Constant(3, std::nan("")), correction, nullptr));
  EXPECT_EQ(root_.Covariance(), before);
}

// GIVEN finite rows beside whose square the identity vanishes THEN the update is refused and nothing changes.
TEST_F(SquareRootCovarianceTest, ApplyRefusesRowsThatLeaveNothingOfTheIdentity) {
  Clone();
  const MatrixXd before = root_.Covariance();
  MatrixXd rows = 1e150 * MatrixXd::Ones(2, root_.dimension());
  VectorXd innovation = VectorXd::Ones(2);
  VectorXd correction(root_.dimension());
  EXPECT_FALSE(root_.Apply(root_.Prepare(rows, innovation), correction, nullptr));
  EXPECT_EQ(root_.Covariance(), before);
}

TEST_F(SquareRootCovarianceTest, UpdateByBlockStaysPositiveUnderRowsFarBetterThanThePrior) {
  Clone();
  for (int i = 0; i < 50; ++i) {
    const MatrixXd rows = 1e9 * RandomMatrix(&random_, 15, 15);
    VectorXd correction(root_.dimension());
    ASSERT_TRUE(root_.UpdateByBlock(0, rows, VectorXd::Zero(15), correction, nullptr));
  }
  const MatrixXd p = root_.Covariance();
  ASSERT_TRUE(p.allFinite());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(p).eigenvalues().minCoeff(), -1e-30);
}

TEST_F(SquareRootCovarianceTest, ZeroedRowsDoNothing) {
  Clone();
  const MatrixXd before = root_.Covariance();
  MatrixXd h = MatrixXd::Zero(5, root_.dimension());
  VectorXd y = VectorXd::Zero(5);
  VectorXd correction(root_.dimension());
  ASSERT_TRUE(root_.Apply(root_.Prepare(h, y), correction, nullptr));
  EXPECT_EQ(correction.norm(), 0.0);
  EXPECT_EQ((root_.Covariance() - before).norm(), 0.0);
}

TEST_F(SquareRootCovarianceTest, TheCorrectionIsKnownBeforeTheUpdateIsMade) {
  Clone();
  AddLeading();
  const MatrixXd before = root_.Covariance();
  const MatrixXd rows = RandomMatrix(&random_, 7, root_.dimension());
  const VectorXd y = RandomMatrix(&random_, 7, 1);
  MatrixXd h = rows;
  VectorXd innovation = y;
  double nis = 0;
  VectorXd foreseen(root_.dimension());
  ASSERT_TRUE(root_.Factor(root_.Prepare(h, innovation), &nis));
  const double moved = root_.Solution(foreseen);
  EXPECT_EQ(root_.Covariance(), before);
  EXPECT_NEAR(moved, (rows * foreseen).squaredNorm(), 1e-9 * moved);
  VectorXd correction(root_.dimension());
  root_.Commit(correction);
  EXPECT_LT((correction - foreseen).norm(), 1e-12 * correction.norm());
  const MatrixXd s = rows * before * rows.transpose() + MatrixXd::Identity(7, 7);
  EXPECT_LT((correction - before * rows.transpose() * s.ldlt().solve(y)).norm(), 1e-9 * correction.norm());
  EXPECT_NEAR(nis, y.dot(s.ldlt().solve(y)), 1e-9 * nis);
  const MatrixXd after = before - before * rows.transpose() * s.ldlt().solve(rows * before);
  EXPECT_LT((root_.Covariance() - after).norm(), 1e-9 * after.norm());
}

// A step S d has the square d^T M d in deviations of the covariance after the update, M = I + A^T A: as much
// as |d|^2 in those before, and as much as its rows move.
TEST_F(SquareRootCovarianceTest, AStepIsMeasuredInDeviationsAfterTheUpdate) {
  Clone();
  AddLeading();
  const MatrixXd s = root_.factor().triangularView<Eigen::Upper>();
  MatrixXd rows = RandomMatrix(&random_, 7, root_.dimension());
  rows.leftCols(2).setZero();  // columns of S that the rows do not see
  MatrixXd h = rows;
  VectorXd innovation = RandomMatrix(&random_, 7, 1);
  ASSERT_TRUE(root_.Factor(root_.Prepare(h, innovation), nullptr));
  VectorXd correction(root_.dimension());
  root_.Solution(correction);
  EXPECT_LT((s * root_.WhitenedSolution() - correction).norm(), 1e-12 * correction.norm());
  const VectorXd from = RandomMatrix(&random_, root_.dimension(), 1);
  const VectorXd step = root_.WhitenedSolution() - from;
  const double expected = step.squaredNorm() + (rows * s * step).squaredNorm();
  EXPECT_NEAR(root_.SquaredStep(from), expected, 1e-9 * expected);
  EXPECT_EQ(root_.SquaredStep(root_.WhitenedSolution()), 0);
}

TEST_F(SquareRootCovarianceTest, RowsThatAreNotFiniteAreRefusedAndChangeNothing) {
  const MatrixXd before = root_.Covariance();
  MatrixXd h = MatrixXd::Ones(3, root_.dimension());
  h(1, 2) = std::nan("");
  VectorXd y = VectorXd::Zero(3);
  VectorXd correction(root_.dimension());
  const PreparedRows prepared = root_.Prepare(h, y);
  EXPECT_FALSE(root_.Apply(prepared, correction, nullptr));
  EXPECT_EQ(root_.Covariance(), before);
  EXPECT_TRUE(std::isnan(root_.NormalizedInnovationSquared(prepared, 0, 3)));
  EXPECT_TRUE(std::isnan(root_.NormalizedInnovationSquared(prepared, 0, 2)));
}

TEST_F(SquareRootCovarianceTest, StaysPositiveWhereTheSubtractiveFormDoesNot) {
  Clone();
  // A measurement 1e9 times better than the prior, many times over: P - K H P loses all digits.
  for (int i = 0; i < 50; ++i) {
    MatrixXd h = 1e9 * RandomMatrix(&random_, 30, root_.dimension());
    VectorXd y = VectorXd::Zero(30);
    VectorXd correction(root_.dimension());
    ASSERT_TRUE(root_.Apply(root_.Prepare(h, y), correction, nullptr));
  }
  const MatrixXd p = root_.Covariance();
  ASSERT_TRUE(p.allFinite());
  EXPECT_EQ((p - p.transpose()).norm(), 0.0);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(p).eigenvalues().minCoeff(), -1e-30);
}

TEST(SquareRootCovarianceErrorsTest, RefusesWhatIsNoCovariance) {
  SquareRootCovariance root(21);
  Matrix15d negative = Matrix15d::Identity();
  negative(3, 3) = -1;
  EXPECT_FALSE(root.Reset(negative).ok());
  Matrix15d skewed = Matrix15d::Identity();
  skewed(0, 1) = 0.5;
  EXPECT_FALSE(root.Reset(skewed).ok());
  Matrix15d nan = Matrix15d::Identity();
  nan(2, 2) = std::nan("");
  EXPECT_FALSE(root.Reset(nan).ok());
  Matrix15d certain = Matrix15d::Identity();
  certain.topLeftCorner<6, 6>().setZero();
  EXPECT_TRUE(root.Reset(certain).ok()) << "a known start is a covariance too";
}

}  // namespace
}  // namespace alidade
