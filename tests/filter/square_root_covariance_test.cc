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
    MatrixXd f = MatrixXd::Identity(dense_.rows(), dense_.rows());
    f.block(leading_, leading_, 15, 15) = phi;
    dense_ = f * dense_ * f.transpose();
    dense_.block(leading_, leading_, 15, 15) += b * b.transpose();
    root_.Propagate(phi, b);
  }

  void Clone() {
    const Eigen::Index n = dense_.rows();
    const Eigen::Index head = leading_ + 15;
    MatrixXd j = MatrixXd::Zero(n + 6, n);
    j.topLeftCorner(head, head).setIdentity();
    j.block(head, leading_, 6, 6).setIdentity();
    j.bottomRightCorner(n - head, n - head).setIdentity();
    dense_ = j * dense_ * j.transpose();
    root_.CloneCore(0, 6);
  }

  /// f = gain x + root n.
  void AddLeading() {
    const Eigen::Index n = dense_.rows();
    const MatrixXd gain = RandomMatrix(&random_, 3, n - leading_);
    const Eigen::Matrix3d root = RandomMatrix(&random_, 3, 3).triangularView<Eigen::Upper>();
    MatrixXd j = MatrixXd::Zero(n + 3, n);
    j.topRightCorner(3, n - leading_) = gain;
    j.bottomRows(n).setIdentity();
    dense_ = j * dense_ * j.transpose();
    dense_.topLeftCorner(3, 3) += root * root.transpose();
    root_.AddLeading(root, gain);
    leading_ += 3;
  }

  void AddToLeading(int target, int source) {
    const Eigen::Index n = dense_.rows();
    const Eigen::Matrix3d m = RandomMatrix(&random_, 3, 3);
    MatrixXd j = MatrixXd::Identity(n, n);
    j.block(target, source, 3, 3) = m;
    dense_ = j * dense_ * j.transpose();
    root_.AddToLeading(target, m, source);
  }

  void Remove(int first, int size = 6) {
    const Eigen::Index n = dense_.rows();
    MatrixXd keep = MatrixXd::Zero(n - size, n);
    keep.topLeftCorner(first, first).setIdentity();
    keep.bottomRightCorner(n - size - first, n - size - first).setIdentity();
    dense_ = keep * dense_ * keep.transpose();
    root_.Remove(first, size);
    leading_ -= first < leading_ ? size : 0;
  }

  /// 40 rows that do not see the first `unseen` errors, and `sparse` rows with three entries each.
  void Update(int unseen = 0, int sparse = 0) {
    const Eigen::Index n = dense_.rows();
    const Eigen::Index rows = 40 + sparse;
    MatrixXd h = RandomMatrix(&random_, rows, n);
    h.leftCols(unseen).setZero();
    for (Eigen::Index row = 40; row < rows; ++row) {
      const Eigen::Index landmark = row % n;
      h.row(row).setZero();
      h(row, landmark) = random_.Normal();
      h(row, n - 6) = random_.Normal();
      h(row, n - 1) = random_.Normal();
    }
    VectorXd y = RandomMatrix(&random_, rows, 1);
    const MatrixXd s = h * dense_ * h.transpose() + MatrixXd::Identity(rows, rows);
    const MatrixXd gain = s.ldlt().solve(h * dense_).transpose();
    const VectorXd expected = gain * y;
    const double nis = y.dot(s.ldlt().solve(y));
    const MatrixXd rest = MatrixXd::Identity(n, n) - gain * h;
    dense_ = rest * dense_ * rest.transpose() + gain * gain.transpose();
    const PreparedRows prepared = root_.Prepare(h, y, sparse > 0 ? 40 : -1);
    for (const auto& [first, count] : {std::pair{0, 40}, std::pair{3, 2}, std::pair{7, 5}}) {
      const VectorXd part = y.segment(first, count);
      const double block_nis = part.dot(s.block(first, first, count, count).ldlt().solve(part));
      EXPECT_NEAR(root_.NormalizedInnovationSquared(prepared, first, count), block_nis, 1e-9 * block_nis);
    }
    VectorXd correction(root_.dimension());
    double measured = 0;
    ASSERT_TRUE(root_.Apply(prepared, correction, &measured));
    EXPECT_NEAR(measured, nis, 1e-9 * nis);
    EXPECT_LT((correction - expected).norm(), 1e-10 * expected.norm());
  }

  /// `count` rows that see the errors [first, first + size) and the last `constants` alone.
  void UpdateByBlock(int first, int size, int count, int constants = 0) {
    const Eigen::Index n = dense_.rows();
    const MatrixXd rows = RandomMatrix(&random_, count, size);
    const VectorXd y = RandomMatrix(&random_, count, 1);
    MatrixXd h = MatrixXd::Zero(count, n);
    h.middleCols(first, size) = rows;
    const MatrixXd behind = RandomMatrix(&random_, count, constants);
    h.rightCols(constants) = behind;
    const MatrixXd s = h * dense_ * h.transpose() + MatrixXd::Identity(count, count);
    const MatrixXd gain = s.ldlt().solve(h * dense_).transpose();
    EXPECT_LT((root_.Block(first, size) - dense_.block(first, first, size, size)).norm(),
              1e-10 * dense_.norm());
    const MatrixXd rest = MatrixXd::Identity(n, n) - gain * h;
    dense_ = rest * dense_ * rest.transpose() + gain * gain.transpose();
    VectorXd correction(n);
    double nis = 0;
    ASSERT_TRUE(root_.UpdateByBlock(first, rows, y, correction, &nis, behind));
    EXPECT_NEAR(nis, y.dot(s.ldlt().solve(y)), 1e-9 * nis);
    EXPECT_LT((correction - gain * y).norm(), 1e-10 * correction.norm());
  }

  void ExpectEqual() {
    ASSERT_EQ(root_.dimension(), dense_.rows());
    const double scale = std::max(1.0, dense_.norm());
    EXPECT_LT((root_.Covariance() - dense_).norm(), 1e-10 * scale);
    EXPECT_EQ(root_.leading(), leading_);
    EXPECT_LT((root_.CoreCovariance() - dense_.block(leading_, leading_, 15, 15)).norm(), 1e-10 * scale);
    const MatrixXd below = root_.factor().triangularView<Eigen::StrictlyLower>();
    EXPECT_EQ(below.norm(), 0.0);
  }

  RandomStream random_{1, "square root covariance"};
  MatrixXd dense_;
  int leading_ = 0;
  SquareRootCovariance root_{15 + 6 * 8 + 3 * 4, 3 * 4};
};

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
