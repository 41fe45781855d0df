#include "eval/metrics/nees.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "eval/metrics/state_pair.h"
#include "tests/eval/trajectory/synthetic_trajectory.h"

namespace alidade {
namespace {

using test::PerfectPairs;

/// Estimates drawn from their own covariance: R_truth = R_est Exp(phi), p_truth = p_est + dp, (phi, dp) ~
/// N(0, P).
std::vector<StatePair> ConsistentPairs(int count, double inflation, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<StatePair> pairs = PerfectPairs(count);
  for (StatePair& pair : pairs) {
    // Orientation a thousand times finer than position: what real estimators report.
    Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(random); });
    root.topRows<3>() *= 1e-3;
    const Matrix6d covariance = root * root.transpose();
    const Vector6d draw = Vector6d::NullaryExpr([&] { return normal(random); });
    const Vector6d error = covariance.llt().matrixL() * draw;
    pair.estimate.nav.R_WB = pair.truth.nav.R_WB * so3::Exp(-error.head<3>());
    pair.estimate.nav.p_WB = pair.truth.nav.p_WB - error.tail<3>();
    pair.estimate.covariance = inflation * covariance;
  }
  return pairs;
}

TEST(Nees, OfAConsistentEstimatorLiesInItsBand) {
  std::mt19937_64 random(2);
  const int count = 20000;
  const NeesResult nees = ComputeNees(ConsistentPairs(count, 1, random));
  const auto within = [&](double mean, int dof) {
    const auto [low, high] = NeesBand(dof, count, 0.999);
    EXPECT_GT(mean, low);
    EXPECT_LT(mean, high);
  };
  within(nees.mean_pose, 6);
  within(nees.mean_orientation, 3);
  within(nees.mean_position, 3);
  EXPECT_NEAR(nees.coverage_3sigma, 0.9973, 0.001);
  EXPECT_EQ(nees.pose.size(), 20000u);
}

TEST(Nees, OfAnOverconfidentEstimatorLiesAboveItsBandAndItsCoverageFalls) {
  std::mt19937_64 random(2);
  const NeesResult nees = ComputeNees(ConsistentPairs(4000, 0.25, random));
  EXPECT_NEAR(nees.mean_pose, 24, 1);
  EXPECT_GT(nees.mean_pose, NeesBand(6, 4000).second);
  EXPECT_NEAR(nees.coverage_3sigma, std::erf(1.5 / std::sqrt(2)), 0.005);
}

/// Truth and estimate both with errors of their own, each drawn from its covariance about the exact motion.
std::vector<StatePair> PairsWithUncertainTruth(int count, double truth_rad, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<StatePair> pairs = PerfectPairs(count);
  for (StatePair& pair : pairs) {
    const NavState exact = pair.truth.nav;
    for (TrajectoryPoint* point : {&pair.truth, &pair.estimate}) {
      Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(random); });
      root.topRows<3>() *= point == &pair.truth ? truth_rad : 1e-2;
      const Vector6d error = root * Vector6d::NullaryExpr([&] { return normal(random); });
      point->nav.R_WB = exact.R_WB * so3::Exp(-error.head<3>());
      point->nav.p_WB = exact.p_WB - error.tail<3>();
      point->covariance = root * root.transpose();
    }
  }
  return pairs;
}

TEST(Nees, GivenATruthWithACovarianceThenBothCount) {
  std::mt19937_64 random(3);
  const int count = 20000;
  std::vector<StatePair> pairs = PairsWithUncertainTruth(count, 1e-2, random);
  const NeesResult nees = ComputeNees(pairs);
  const auto within = [&](double mean, int dof) {
    const auto [low, high] = NeesBand(dof, count, 0.999);
    EXPECT_GT(mean, low);
    EXPECT_LT(mean, high);
  };
  within(nees.mean_pose, 6);
  within(nees.mean_orientation, 3);
  within(nees.mean_position, 3);
  EXPECT_NEAR(nees.coverage_3sigma, 0.9973, 0.001);
  for (StatePair& pair : pairs) {
    pair.truth.covariance.setZero();
  }
  EXPECT_GT(ComputeNees(pairs).mean_pose, NeesBand(6, count).second) << "the truth's error is no error then";
}

TEST(Nees, TheErrorOfTheTruthIsTurnedIntoThatOfTheEstimate) {
  // Far apart, so that the chart of the truth is not that of the estimate: Log(R_est^T R_truth Exp(phi_t)) by
  // central differences.
  std::mt19937_64 random(4);
  StatePair pair = PairsWithUncertainTruth(3, 1e-3, random)[1];
  pair.estimate.nav.R_WB = pair.truth.nav.R_WB * so3::Exp(Eigen::Vector3d(0.8, -0.5, 0.6));
  Matrix6d jacobian = Matrix6d::Identity();
  const double step = 1e-5;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d phi = step * Eigen::Vector3d::Unit(i);
    const auto error = [&](const Eigen::Vector3d& turn) {
      return so3::Log(pair.estimate.nav.R_WB.transpose() * pair.truth.nav.R_WB * so3::Exp(turn));
    };
    jacobian.col(i).head<3>() = (error(phi) - error(-phi)) / (2 * step);
  }
  const Matrix6d expected =
      pair.estimate.covariance + jacobian * pair.truth.covariance * jacobian.transpose();
  EXPECT_LT((ErrorCovariance(pair) - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.cwiseAbs().maxCoeff());
  pair.truth.covariance.setZero();
  EXPECT_EQ(ErrorCovariance(pair), pair.estimate.covariance);
}

TEST(Nees, OfOneHandComputedPair) {
  std::vector<StatePair> pairs = PerfectPairs(1);
  StatePair& pair = pairs[0];
  pair.estimate.nav.p_WB = pair.truth.nav.p_WB - Eigen::Vector3d(0.1, 0, 0.7);
  pair.estimate.nav.R_WB = pair.truth.nav.R_WB * so3::Exp({0, -0.02, 0});
  Vector6d variance;
  variance << 1e-4, 1e-4, 1e-4, 0.01, 0.01, 0.04;
  pair.estimate.covariance = variance.asDiagonal();
  const NeesResult nees = ComputeNees(pairs);
  EXPECT_NEAR(nees.orientation[0], 4, 1e-9);
  EXPECT_NEAR(nees.position[0], 1 + 0.49 / 0.04, 1e-9);
  EXPECT_NEAR(nees.pose[0], 4 + 1 + 0.49 / 0.04, 1e-9);
  EXPECT_NEAR(nees.coverage_3sigma, 5.0 / 6, 1e-12);  // 0.7 m is 3.5 sigma
}

TEST(Nees, OfVelocityAndBiasesIsThatOfOneHandComputedPair) {
  std::vector<StatePair> pairs = PerfectPairs(1);
  StatePair& pair = pairs[0];
  pair.estimate.nav.v_WB = pair.truth.nav.v_WB - Eigen::Vector3d(0.3, 0, 0.1);
  pair.estimate.bias.gyro = pair.truth.bias.gyro - Eigen::Vector3d(0, 2e-3, 0);
  pair.estimate.bias.accel = pair.truth.bias.accel - Eigen::Vector3d(0.05, 0.05, 0);
  MotionCovariance& covariance = pair.estimate.motion_covariance;
  EXPECT_TRUE(std::isnan(ComputeNees(pairs).mean_velocity)) << "no covariance of it is known";
  covariance.velocity.diagonal() << 0.01, 0.01, 0.04;
  covariance.gyro_bias = 1e-6 * Eigen::Matrix3d::Identity();
  covariance.accel_bias << 2, 1, 0, 1, 2, 0, 0, 0, 1;
  covariance.accel_bias *= 1e-4;
  const NeesResult nees = ComputeNees(pairs);
  EXPECT_NEAR(nees.mean_velocity, 0.09 / 0.01 + 0.01 / 0.04, 1e-9);
  EXPECT_NEAR(nees.mean_gyro_bias, 4, 1e-9);
  // The inverse of [2 1; 1 2] is [2 -1; -1 2] / 3: 25 (2 - 1 - 1 + 2) / 3.
  EXPECT_NEAR(nees.mean_accel_bias, 50.0 / 3, 1e-9);
}

TEST(Nees, ReadsTheErrorInTheBodyFrame) {
  // A covariance tight about the body's x alone separates a body-frame error from a world-frame one.
  std::vector<StatePair> pairs = PerfectPairs(1);
  pairs[0].estimate.nav.R_WB = so3::Exp({0, 0, M_PI / 2});
  pairs[0].truth.nav.R_WB = pairs[0].estimate.nav.R_WB * so3::Exp({0.01, 0, 0});
  Vector6d variance = Vector6d::Ones();
  variance[0] = 1e-6;
  pairs[0].estimate.covariance = variance.asDiagonal();
  EXPECT_NEAR(ComputeNees(pairs).orientation[0], 100, 1e-6);
}

TEST(Nees, OfASingularOrSenselessCovarianceIsNotANumberAndDoesNotCount) {
  std::mt19937_64 random(9);
  std::vector<StatePair> pairs = ConsistentPairs(5, 1, random);
  const NeesResult good = ComputeNees(pairs);
  for (int fault = 0; fault < 4; ++fault) {
    pairs.push_back(pairs[static_cast<std::size_t>(fault)]);
  }
  pairs[5].estimate.covariance.setZero();
  pairs[6].estimate.covariance.setConstant(0.1);  // rank one
  pairs[7].estimate.covariance(2, 2) = NAN;
  pairs[8].estimate.covariance *= -1;
  const NeesResult nees = ComputeNees(pairs);
  for (std::size_t i = 5; i < 9; ++i) {
    EXPECT_TRUE(std::isnan(nees.pose[i])) << i;
  }
  EXPECT_EQ(nees.mean_pose, good.mean_pose);
  EXPECT_EQ(nees.coverage_3sigma, good.coverage_3sigma);
}

TEST(Nees, OfNoCovarianceAtAllIsNotANumber) {
  const NeesResult nees = ComputeNees(PerfectPairs(10));
  EXPECT_TRUE(std::isnan(nees.mean_pose));
  EXPECT_TRUE(std::isnan(nees.coverage_3sigma));
}

TEST(NeesBand, AgreesWithTabulatedChiSquareQuantiles) {
  // Quantiles 0.025 and 0.975 of chi-square with 3, 6 and 60 degrees of freedom (Abramowitz and Stegun,
  // table 26.8).
  EXPECT_NEAR(NeesBand(3, 1).first, 0.215795, 1e-5);
  EXPECT_NEAR(NeesBand(3, 1).second, 9.34840, 1e-4);
  EXPECT_NEAR(NeesBand(6, 1).first, 1.237347, 1e-5);
  EXPECT_NEAR(NeesBand(6, 1).second, 14.4494, 1e-4);
  EXPECT_NEAR(NeesBand(6, 10).first, 40.4817 / 10, 1e-4);
  EXPECT_NEAR(NeesBand(6, 10).second, 83.2976 / 10, 1e-4);
}

TEST(NeesBand, OfSenselessArgumentsIsNotANumber) {
  for (const auto& [low, high] : {NeesBand(6, 0), NeesBand(0, 5), NeesBand(6, NAN), NeesBand(6, 5, 1.0)}) {
    EXPECT_TRUE(std::isnan(low));
    EXPECT_TRUE(std::isnan(high));
  }
}

}  // namespace
}  // namespace alidade
