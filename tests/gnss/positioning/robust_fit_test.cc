#include "gnss/positioning/robust_fit.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace alidade {
namespace {

TEST(RobustFitTest, PlainStepIsLeastSquares) {
  WhitenedRows rows;
  rows.jacobian.resize(3, 1);
  rows.jacobian << 1, 1, 2;
  rows.residual.resize(3);
  rows.residual << -1, -3, -4;
  rows.measurements = 3;
  const std::optional<RobustFit> fit = RobustStep(rows, RobustKernel::kNone, 1, true);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->step[0], 12.0 / 6, 1e-12);
  EXPECT_NEAR(fit->covariance(0, 0), 1.0 / 6, 1e-12);
}

TEST(RobustFitTest, CovarianceIsTheInverseOfTheNormalMatrixWhateverTheColumnsOrder) {
  RandomStream random(5, "rows");
  WhitenedRows rows;
  rows.jacobian.resize(12, 4);
  rows.residual.setZero(12);
  rows.measurements = 12;
  for (Eigen::Index i = 0; i < rows.jacobian.size(); ++i) {
    rows.jacobian.data()[i] = random.Normal() * (i % 4 + 1);
  }
  const std::optional<RobustFit> fit = RobustStep(rows, RobustKernel::kHuber, 1.5, false);
  ASSERT_TRUE(fit.has_value());
  const Eigen::MatrixXd identity = fit->covariance * rows.jacobian.transpose() * rows.jacobian;
  EXPECT_LT((identity - Eigen::MatrixXd::Identity(4, 4)).norm(), 1e-10);
}

TEST(RobustFitTest, OutliersLoseWeightAndPriorsDoNot) {
  // A mean of ten zeros and one outlier of 100, found by repeated steps from the mean.
  double x = 100.0 / 11;
  for (int i = 0; i < 50; ++i) {
    WhitenedRows rows;
    rows.jacobian.setOnes(11, 1);
    rows.residual.setConstant(11, x);
    rows.residual[10] = x - 100;
    rows.measurements = 11;
    x += RobustStep(rows, RobustKernel::kHuber, 1.5, true)->step[0];
  }
  EXPECT_NEAR(x, 0.15, 1e-6) << "Huber: 10 x = 1.5";
  WhitenedRows prior;
  prior.jacobian.setOnes(2, 1);
  prior.residual.resize(2);
  prior.residual << 0, -100;
  prior.measurements = 1;
  EXPECT_NEAR(RobustStep(prior, RobustKernel::kHuber, 1.5, true)->step[0], 50, 1e-9);
}

TEST(RobustFitTest, UndeterminedOrBrokenSystemsGiveNothing) {
  WhitenedRows rows;
  rows.jacobian.setOnes(3, 2);
  rows.residual.setZero(3);
  rows.measurements = 3;
  EXPECT_FALSE(RobustStep(rows, RobustKernel::kHuber, 1.5, true).has_value());
  rows.jacobian(0, 0) = std::nan("");
  EXPECT_FALSE(RobustStep(rows, RobustKernel::kHuber, 1.5, true).has_value());
  rows.jacobian.setOnes(1, 2);
  rows.residual.setZero(1);
  EXPECT_FALSE(RobustStep(rows, RobustKernel::kHuber, 1.5, true).has_value());
}

TEST(RobustFitTest, ScaleIsTheDeviationOfTheMajority) {
  RandomStream random(9, "scale");
  std::vector<double> whitened;
  whitened.reserve(1001);
  for (int i = 0; i < 1001; ++i) {
    whitened.push_back(i % 5 == 0 ? 1000 : 3 * random.Normal());
  }
  EXPECT_NEAR(RobustScale(whitened, 4), 3 * 1.25, 0.5) << "a fifth of outliers moves the median by a quarter";
  EXPECT_EQ(RobustScale({0.1, 0.2, 0.1, 0.3, 0.1, 0.2}, 4), 1) << "never below one";
  EXPECT_EQ(RobustScale({100, 100, 100, 100}, 4), 1) << "no redundancy";
}

}  // namespace
}  // namespace alidade
