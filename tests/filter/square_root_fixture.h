#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <utility>

#include "core/random.h"
#include "filter/square_root_covariance.h"

namespace alidade::test {

inline Eigen::MatrixXd RandomMatrix(RandomStream* random, Eigen::Index rows, Eigen::Index cols) {
  Eigen::MatrixXd m(rows, cols);
  for (Eigen::Index i = 0; i < m.size(); ++i) {
    m.data()[i] = random->Normal();
  }
  return m;
}

/// A dense covariance that is put through the same operations as the factor.
class SquareRootCovarianceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const Eigen::MatrixXd a = RandomMatrix(&random_, 15, 15);
    dense_ = a * a.transpose() + 0.1 * Eigen::MatrixXd::Identity(15, 15);
    ASSERT_TRUE(root_.Reset(dense_).ok());
  }

  void Propagate() {
    const Eigen::MatrixXd phi = Eigen::MatrixXd::Identity(15, 15) + 0.1 * RandomMatrix(&random_, 15, 15);
    const Eigen::MatrixXd b = 0.1 * RandomMatrix(&random_, 15, 15);
    Eigen::MatrixXd f = Eigen::MatrixXd::Identity(dense_.rows(), dense_.rows());
    f.block(leading_, leading_, 15, 15) = phi;
    dense_ = f * dense_ * f.transpose();
    dense_.block(leading_, leading_, 15, 15) += b * b.transpose();
    root_.Propagate(phi, b);
  }

  void Clone() {
    const Eigen::Index n = dense_.rows();
    const Eigen::Index head = leading_ + 15;
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(n + 6, n);
    j.topLeftCorner(head, head).setIdentity();
    j.block(head, leading_, 6, 6).setIdentity();
    j.bottomRightCorner(n - head, n - head).setIdentity();
    dense_ = j * dense_ * j.transpose();
    root_.CloneCore(0, 6);
  }

  /// f = gain x + root n.
  void AddLeading() {
    const Eigen::Index n = dense_.rows();
    const Eigen::MatrixXd gain = RandomMatrix(&random_, 3, n - leading_);
    const Eigen::Matrix3d root = RandomMatrix(&random_, 3, 3).triangularView<Eigen::Upper>();
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(n + 3, n);
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
    Eigen::MatrixXd j = Eigen::MatrixXd::Identity(n, n);
    j.block(target, source, 3, 3) = m;
    dense_ = j * dense_ * j.transpose();
    root_.AddToLeading(target, m, source);
  }

  void Shear() {
    const Eigen::Index n = dense_.rows();
    const Eigen::VectorXd column = 0.1 * RandomMatrix(&random_, n, 1);
    Eigen::VectorXd row = 0.1 * RandomMatrix(&random_, n, 1);
    row.head(n / 3).setZero();
    const Eigen::MatrixXd j = Eigen::MatrixXd::Identity(n, n) + column * row.transpose();
    dense_ = j * dense_ * j.transpose();
    root_.Shear(column, row);
  }

  void Remove(int first, int size = 6) {
    const Eigen::Index n = dense_.rows();
    Eigen::MatrixXd keep = Eigen::MatrixXd::Zero(n - size, n);
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
    Eigen::MatrixXd h = RandomMatrix(&random_, rows, n);
    h.leftCols(unseen).setZero();
    for (Eigen::Index row = 40; row < rows; ++row) {
      const Eigen::Index landmark = row % n;
      h.row(row).setZero();
      h(row, landmark) = random_.Normal();
      h(row, n - 6) = random_.Normal();
      h(row, n - 1) = random_.Normal();
    }
    Eigen::VectorXd y = RandomMatrix(&random_, rows, 1);
    const Eigen::MatrixXd s = h * dense_ * h.transpose() + Eigen::MatrixXd::Identity(rows, rows);
    const Eigen::MatrixXd gain = s.ldlt().solve(h * dense_).transpose();
    const Eigen::VectorXd expected = gain * y;
    const double nis = y.dot(s.ldlt().solve(y));
    const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(n, n) - gain * h;
    dense_ = rest * dense_ * rest.transpose() + gain * gain.transpose();
    const PreparedRows prepared = root_.Prepare(h, y, sparse > 0 ? 40 : -1);
    for (const auto& [first, count] : {std::pair{0, 40}, std::pair{3, 2}, std::pair{7, 5}}) {
      const Eigen::VectorXd part = y.segment(first, count);
      const double block_nis = part.dot(s.block(first, first, count, count).ldlt().solve(part));
      EXPECT_NEAR(root_.NormalizedInnovationSquared(prepared, first, count), block_nis, 1e-9 * block_nis);
    }
    Eigen::VectorXd correction(root_.dimension());
    double measured = 0;
    ASSERT_TRUE(root_.Apply(prepared, correction, &measured));
    EXPECT_NEAR(measured, nis, 1e-9 * nis);
    EXPECT_LT((correction - expected).norm(), 1e-10 * expected.norm());
  }

  /// `count` rows that see the errors [first, first + size) and the last `constants` alone.
  void UpdateByBlock(int first, int size, int count, int constants = 0) {
    const Eigen::Index n = dense_.rows();
    const Eigen::MatrixXd rows = RandomMatrix(&random_, count, size);
    const Eigen::VectorXd y = RandomMatrix(&random_, count, 1);
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(count, n);
    h.middleCols(first, size) = rows;
    const Eigen::MatrixXd behind = RandomMatrix(&random_, count, constants);
    h.rightCols(constants) = behind;
    const Eigen::MatrixXd s = h * dense_ * h.transpose() + Eigen::MatrixXd::Identity(count, count);
    const Eigen::MatrixXd gain = s.ldlt().solve(h * dense_).transpose();
    EXPECT_LT((root_.Block(first, size) - dense_.block(first, first, size, size)).norm(),
              1e-10 * dense_.norm());
    const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(n, n) - gain * h;
    dense_ = rest * dense_ * rest.transpose() + gain * gain.transpose();
    Eigen::VectorXd correction(n);
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
    const Eigen::MatrixXd below = root_.factor().triangularView<Eigen::StrictlyLower>();
    EXPECT_EQ(below.norm(), 0.0);
  }

  RandomStream random_{1, "square root covariance"};
  Eigen::MatrixXd dense_;
  int leading_ = 0;
  SquareRootCovariance root_{15 + 6 * 8 + 3 * 4, 3 * 4};
};

}  // namespace alidade::test
