#include "core/lie.h"

#include <gtest/gtest.h>

#include <unsupported/Eigen/MatrixFunctions>

#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::NumericJacobian;
using test::RandomStates;

// Angles around every threshold of the series, and close to pi.
constexpr double kAngles[] = {0, 1e-12, 1e-8, 1e-5, 9.9e-3, 1.01e-2, 0.299, 0.301, 1.0, 2.5, 3.1, 3.14159};

class So3AtAngle : public ::testing::TestWithParam<double> {
 protected:
  Vector3d phi_ = GetParam() * Vector3d(0.36, -0.48, 0.8);
};
INSTANTIATE_TEST_SUITE_P(AllAngles, So3AtAngle, ::testing::ValuesIn(kAngles));

TEST(So3Test, TheNearestYawIsNearerThanAnyOther) {
  RandomStates random(17);
  for (int trial = 0; trial < 20; ++trial) {
    // A rotation, and the moment of two sets of vectors that no rotation maps onto each other.
    Matrix3d m = random.RandomPose(1).rotation;
    for (int i = 0; trial % 2 == 1 && i < 4; ++i) {
      m += random.Vector(1) * random.Vector(1).transpose();
    }
    const auto distance = [&](double yaw) { return (m - so3::Exp(Vector3d(0, 0, yaw))).norm(); };
    const double yaw = so3::NearestYaw(m);
    EXPECT_LE(std::abs(yaw), M_PI);
    for (int k = 1; k < 360; ++k) {
      EXPECT_LT(distance(yaw), distance(yaw + k * M_PI / 180));
    }
  }
  EXPECT_NEAR(so3::NearestYaw(so3::Exp(Vector3d(0, 0, -2.5))), -2.5, 1e-15);
  EXPECT_EQ(so3::NearestYaw(Matrix3d::Zero()), 0);
}

TEST_P(So3AtAngle, ExpIsTheMatrixExponential) {
  const Matrix3d reference = Skew(phi_).exp();
  EXPECT_LT((so3::Exp(phi_) - reference).norm(), 1e-13);
}

TEST_P(So3AtAngle, LogInvertsExp) {
  EXPECT_LT((so3::Log(so3::Exp(phi_)) - phi_).norm(), 1e-9 + 1e-15 * GetParam());
}

TEST_P(So3AtAngle, GammaIsItsPowerSeries) {
  for (int m = 0; m < 4; ++m) {
    Matrix3d sum = Matrix3d::Zero();
    Matrix3d power = Matrix3d::Identity();
    double factorial = std::tgamma(m + 1.0);
    for (int k = 0; k < 40; ++k) {
      sum += power / factorial;
      power = power * Skew(phi_);
      factorial *= k + m + 1;
    }
    EXPECT_LT((so3::Gamma(phi_, m) - sum).norm(), 2e-13) << "m = " << m;
  }
}

TEST_P(So3AtAngle, GammaDerivativeDifferentiatesGamma) {
  const Vector3d v(0.3, -1.2, 0.7);
  for (int m = 0; m <= 2; ++m) {
    const auto f = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
      return so3::Gamma(phi_ + Vector3d(d), m) * v;
    };
    EXPECT_EQ(test::CompareJacobians(so3::GammaDerivative(phi_, v, m), test::NumericJacobian(f, 3), 1e-9), "")
        << "m = " << m;
  }
}

TEST_P(So3AtAngle, LeftAndRightJacobiansDifferentiateExp) {
  const auto left = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
    return so3::Log(so3::Exp(phi_ + Vector3d(d)) * so3::Exp(phi_).transpose());
  };
  const auto right = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
    return so3::Log(so3::Exp(phi_).transpose() * so3::Exp(phi_ + Vector3d(d)));
  };
  EXPECT_EQ(test::CompareJacobians(so3::LeftJacobian(phi_), NumericJacobian(left, 3), 1e-9), "");
  EXPECT_EQ(test::CompareJacobians(so3::RightJacobian(phi_), NumericJacobian(right, 3), 1e-9), "");
}

TEST_P(So3AtAngle, InverseJacobiansInvert) {
  EXPECT_LT((so3::LeftJacobianInverse(phi_) * so3::LeftJacobian(phi_) - Matrix3d::Identity()).norm(), 1e-11);
  EXPECT_LT((so3::RightJacobianInverse(phi_) * so3::RightJacobian(phi_) - Matrix3d::Identity()).norm(),
            1e-11);
}

TEST(So3Test, LogIsWellDefinedAtPi) {
  const Matrix3d half_turn = Vector3d(-1, -1, 1).asDiagonal();
  EXPECT_NEAR(so3::Log(half_turn).norm(), M_PI, 1e-12);
}

TEST(So3Test, NormalizeFindsTheNearestRotation) {
  RandomStates random(3);
  const Matrix3d rotation = random.Rotation();
  Matrix3d noisy = rotation;
  noisy(0, 1) += 1e-4;
  const Matrix3d mended = so3::Normalize(noisy);
  EXPECT_LT((mended.transpose() * mended - Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((mended - rotation).norm(), 1e-4);
  EXPECT_GT(so3::Normalize(-Matrix3d::Identity()).determinant(), 0);
}

}  // namespace
}  // namespace alidade
