#include "filter/square_root_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/random.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd RandomMatrix(RandomStream* random, Eigen::Index rows, Eigen::Index cols) {
  MatrixXd m(rows, cols);
  for (Eigen::Index i = 0; i < m.size(); ++i) {
    m.data()[i] = random->Normal();
  }
  return m;
}

/// A dense covariance that is put through the same operations as the factor.
class SquareRootCovarianceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const MatrixXd a = RandomMatrix(&random_, 15, 15);
    dense_ = a * a.transpose() + 0.1 * MatrixXd::Identity(15, 15);
    ASSERT_TRUE(root_.Reset(dense_).ok());
  }

  void Propagate() {
    const MatrixXd phi = MatrixXd::Identity(15, 15) + 0.1 * RandomMatrix(&random_, 15, 15);
    const MatrixXd b = 0.1 * RandomMatrix(&random_, 15, 15);
    const MatrixXd q = b * b.transpose();
    MatrixXd f = MatrixXd::Identity(dense_.rows(), dense_.rows());
    f.topLeftCorner(15, 15) = phi;
    dense_ = f * dense_ * f.transpose();
    dense_.topLeftCorner(15, 15) += q;
    root_.Propagate(phi, q);
  }

  void Clone() {
    const Eigen::Index n = dense_.rows();
    MatrixXd j = MatrixXd::Zero(n + 6, n);
    j.topLeftCorner(15, 15).setIdentity();
    j.block(15, 0, 6, 6).setIdentity();
    j.bottomRightCorner(n - 15, n - 15).setIdentity();
    dense_ = j * dense_ * j.transpose();
    root_.CloneCore(0, 6);
  }

  void Remove(int first) {
    const Eigen::Index n = dense_.rows();
    MatrixXd keep = MatrixXd::Zero(n - 6, n);
    keep.topLeftCorner(first, first).setIdentity();
    keep.bottomRightCorner(n - 6 - first, n - 6 - first).setIdentity();
    dense_ = keep * dense_ * keep.transpose();
    root_.Remove(first, 6);
  }

  void ExpectEqual() {
    ASSERT_EQ(root_.dimension(), dense_.rows());
    const double scale = std::max(1.0, dense_.norm());
    EXPECT_LT((root_.Covariance() - dense_).norm(), 1e-10 * scale);
    EXPECT_LT((root_.CoreCovariance() - dense_.topLeftCorner(15, 15)).norm(), 1e-10 * scale);
    const MatrixXd below = root_.factor().triangularView<Eigen::StrictlyLower>();
    EXPECT_EQ(below.norm(), 0.0);
  }

  RandomStream random_{1, "square root covariance"};
  MatrixXd dense_;
  SquareRootCovariance root_{15 + 6 * 8};
};

TEST_F(SquareRootCovarianceTest, FollowsTheDenseCovarianceThroughAWindow) {
  for (int frame = 0; frame < 25; ++frame) {
    Propagate();
    ExpectEqual();
    Clone();
    ExpectEqual();
    if (root_.dimension() == root_.capacity()) {
      const int clones = (root_.dimension() - 15) / 6;
      Remove(15 + 6 * (frame % clones));  // oldest, newest and between
      ExpectEqual();
    }
  }
}

TEST_F(SquareRootCovarianceTest, UpdateIsTheKalmanUpdate) {
  for (int frame = 0; frame < 5; ++frame) {
    Propagate();
    Clone();
  }
  for (const bool sees_core : {false, true}) {
    const Eigen::Index n = dense_.rows();
    MatrixXd h = RandomMatrix(&random_, 40, n);
    if (!sees_core) {
      h.leftCols(21).setZero();
    }
    const VectorXd y = RandomMatrix(&random_, 40, 1);
    const MatrixXd s = h * dense_ * h.transpose() + MatrixXd::Identity(40, 40);
    const MatrixXd gain = dense_ * h.transpose() * s.inverse();
    const VectorXd expected = gain * y;
    const double nis = y.dot(s.ldlt().solve(y));
    dense_ = (MatrixXd::Identity(n, n) - gain * h) * dense_;
    root_.Prepare(h);
    VectorXd correction;
    double measured = 0;
    ASSERT_TRUE(root_.Apply(h, y, &correction, &measured));
    EXPECT_NEAR(measured, nis, 1e-9 * nis);
    EXPECT_LT((correction - expected).norm(), 1e-10 * expected.norm());
    ExpectEqual();
  }
}

TEST_F(SquareRootCovarianceTest, ZeroedRowsDoNothing) {
  Clone();
  const MatrixXd before = root_.Covariance();
  MatrixXd h = MatrixXd::Zero(5, root_.dimension());
  VectorXd correction;
  root_.Prepare(h);
  ASSERT_TRUE(root_.Apply(h, VectorXd::Zero(5), &correction, nullptr));
  EXPECT_EQ(correction.norm(), 0.0);
  EXPECT_EQ((root_.Covariance() - before).norm(), 0.0);
}

TEST_F(SquareRootCovarianceTest, RowsThatAreNotFiniteAreRefusedAndChangeNothing) {
  const MatrixXd before = root_.Covariance();
  MatrixXd h = MatrixXd::Ones(3, root_.dimension());
  h(1, 2) = std::nan("");
  VectorXd correction;
  root_.Prepare(h);
  EXPECT_FALSE(root_.Apply(h, VectorXd::Zero(3), &correction, nullptr));
  EXPECT_EQ(root_.Covariance(), before);
}

TEST_F(SquareRootCovarianceTest, StaysPositiveWhereTheSubtractiveFormDoesNot) {
  Clone();
  // A measurement 1e9 times better than the prior, many times over: P - K H P loses all digits.
  for (int i = 0; i < 50; ++i) {
    MatrixXd h = 1e9 * RandomMatrix(&random_, 30, root_.dimension());
    VectorXd correction;
    root_.Prepare(h);
    ASSERT_TRUE(root_.Apply(h, VectorXd::Zero(30), &correction, nullptr));
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
