#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "core/imu_buffer.h"
#include "core/imu_propagation.h"
#include "core/preintegration.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using test::RandomStates;

constexpr double kGravity = 9.81;

std::vector<ImuSample> RandomSamples(RandomStates* random, int count, double rate_hz, double max_rate = 1.5) {
  std::vector<ImuSample> samples;
  const Vector3d omega = random->Vector(max_rate);
  for (int i = 0; i < count; ++i) {
    samples.push_back({SecondsToNs(i / rate_hz), omega + random->Vector(0.3),
                       Vector3d(0, 0, kGravity) + random->Vector(3)});
  }
  return samples;
}

Vector15d LocalWithBias(ErrorConvention convention, const NavState& a, const ImuBias& bias_a,
                        const NavState& b, const ImuBias& bias_b) {
  Vector15d xi;
  xi << Local(convention, a, b), bias_b.gyro - bias_a.gyro, bias_b.accel - bias_a.accel;
  return xi;
}

TEST(ImuPropagationTest, TransitionIsNumericInEveryConvention) {
  RandomStates random(21);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const std::vector<ImuSample> samples = RandomSamples(&random, 12, 100, trial % 2 == 0 ? 1.5 : 30);
      const NavState start = random.Nav(5);
      const ImuBias bias = random.Bias();
      NavState end = start;
      ImuTransition transition;
      PropagateImu(samples, bias, {}, GravityInWorld(kGravity), &end, &transition);
      const auto propagate = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        NavState moved = Retract(convention, start, Vector9d(xi.head<9>()));
        const ImuBias moved_bias{bias.gyro + xi.segment<3>(9), bias.accel + xi.tail<3>()};
        PropagateImu(samples, moved_bias, {}, GravityInWorld(kGravity), &moved, nullptr);
        return LocalWithBias(convention, end, bias, moved, moved_bias);
      };
      const Matrix15d analytic =
          InverseImuChartJacobian(convention, end) * transition.phi * ImuChartJacobian(convention, start);
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(propagate, 15), 1e-8), "")
          << ToString(convention);
    }
  }
}

TEST(ImuPropagationTest, RightInvariantTransitionDoesNotDependOnTheState) {
  RandomStates random(22);
  const std::vector<ImuSample> samples = RandomSamples(&random, 12, 100);
  const auto transition_at = [&](const NavState& start) -> Matrix9d {
    NavState end = start;
    ImuTransition transition;
    PropagateImu(samples, {}, {}, GravityInWorld(kGravity), &end, &transition);
    const Matrix15d phi = InverseImuChartJacobian(ErrorConvention::kRightInvariant, end) * transition.phi *
                          ImuChartJacobian(ErrorConvention::kRightInvariant, start);
    return phi.topLeftCorner<9, 9>();
  };
  const Matrix9d first = transition_at(random.Nav(100));
  for (int i = 0; i < 20; ++i) {
    EXPECT_LT((transition_at(random.Nav(100)) - first).norm(), 1e-10);
  }
}

TEST(ImuPropagationTest, NoiseCovarianceMatchesMonteCarlo) {
  RandomStates random(23);
  constexpr double kRate = 200;
  const std::vector<ImuSample> samples = RandomSamples(&random, 21, kRate);
  const NavState start = random.Nav(2);
  // White noise alone at a density far above the walks, so that 4000 draws determine each variance to 3 %.
  const ImuNoise noise{1e-2, 5e-2, 0, 0};
  NavState end = start;
  ImuTransition transition;
  PropagateImu(samples, {}, noise, GravityInWorld(kGravity), &end, &transition);
  RandomStream draws(24, "noise");
  Matrix9d sum = Matrix9d::Zero();
  constexpr int kDraws = 4000;
  const double root_rate = std::sqrt(kRate);
  for (int draw = 0; draw < kDraws; ++draw) {
    NavState state = start;
    for (size_t k = 0; k + 1 < samples.size(); ++k) {  // independent noise on each step's mean
      const Vector3d omega =
          0.5 * (samples[k].gyro + samples[k + 1].gyro) + 1e-2 * root_rate * draws.Normal3();
      const Vector3d accel =
          0.5 * (samples[k].accel + samples[k + 1].accel) + 5e-2 * root_rate * draws.Normal3();
      PropagateStep(omega, accel, 1 / kRate, noise, GravityInWorld(kGravity), &state, nullptr);
    }
    const Vector9d error = Local(ErrorConvention::kSo3xRn, end, state);
    sum += error * error.transpose() / kDraws;
  }
  const Matrix9d expected = transition.q.topLeftCorner<9, 9>();
  const Eigen::LLT<Matrix9d> factor(expected);
  ASSERT_EQ(factor.info(), Eigen::Success);
  const Matrix9d half = factor.matrixL().solve(sum);
  const Matrix9d whitened = factor.matrixL().solve(half.transpose());
  EXPECT_LT((whitened - Matrix9d::Identity()).cwiseAbs().maxCoeff(), 0.12);
}

TEST(ImuPropagationTest, StandingStillStays) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 100; ++i) {
    samples.push_back({SecondsToNs(i * 0.01), Vector3d::Zero(), Vector3d(0, 0, kGravity)});
  }
  NavState state;
  PropagateImu(samples, {}, {}, GravityInWorld(kGravity), &state, nullptr);
  EXPECT_LT(state.p_WB.norm(), 1e-12);
  EXPECT_LT(state.v_WB.norm(), 1e-12);
}

TEST(PreintegrationTest, AgreesWithPropagationUpToTheIntegrationRule) {
  RandomStates random(25);
  const std::vector<ImuSample> samples = RandomSamples(&random, 41, 400);
  const NavState start = random.Nav(3);
  const ImuBias bias = random.Bias();
  NavState end = start;
  PropagateImu(samples, bias, {}, GravityInWorld(kGravity), &end, nullptr);
  Preintegration preintegration(bias, {});
  preintegration.Add(samples);
  Vector15d residual;
  PreintegrationModel{&preintegration, GravityInWorld(kGravity)}.Evaluate(start, bias, end, bias, &residual,
                                                                          nullptr, nullptr);
  EXPECT_LT(residual.norm(), 2e-5);  // midpoint rule against the closed form
  EXPECT_LT(residual.segment<3>(6).norm(), 1e-12);
}

TEST(PreintegrationTest, ResidualJacobiansAreNumericInEveryConvention) {
  RandomStates random(26);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const std::vector<ImuSample> samples = RandomSamples(&random, 21, 100);
      Preintegration preintegration(random.Bias(), {});
      preintegration.Add(samples);
      const PreintegrationModel model{&preintegration, GravityInWorld(kGravity)};
      const NavState i = random.Nav(3);
      const NavState j = random.Nav(3);
      const ImuBias bias_i = random.Bias();
      const ImuBias bias_j = random.Bias();
      Vector15d residual;
      Matrix15d jacobian_i;
      Matrix15d jacobian_j;
      jacobian_i.setConstant(std::numeric_limits<double>::quiet_NaN());
      jacobian_j.setConstant(std::numeric_limits<double>::quiet_NaN());
      model.Evaluate(i, bias_i, j, bias_j, &residual, &jacobian_i, &jacobian_j);
      Vector15d alone;
      model.Evaluate(i, bias_i, j, bias_j, &alone, nullptr, nullptr);
      EXPECT_EQ(residual, alone);
      const auto move_i = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        Vector15d r;
        model.Evaluate(Retract(convention, i, Vector9d(xi.head<9>())),
                       {bias_i.gyro + xi.segment<3>(9), bias_i.accel + xi.tail<3>()}, j, bias_j, &r, nullptr,
                       nullptr);
        return r;
      };
      const auto move_j = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        Vector15d r;
        model.Evaluate(i, bias_i, Retract(convention, j, Vector9d(xi.head<9>())),
                       {bias_j.gyro + xi.segment<3>(9), bias_j.accel + xi.tail<3>()}, &r, nullptr, nullptr);
        return r;
      };
      EXPECT_EQ(test::CompareJacobians(jacobian_i * ImuChartJacobian(convention, i),
                                       test::NumericJacobian(move_i, 15), 1e-7),
                "");
      EXPECT_EQ(test::CompareJacobians(jacobian_j * ImuChartJacobian(convention, j),
                                       test::NumericJacobian(move_j, 15), 1e-7),
                "");
    }
  }
}

TEST(PreintegrationTest, BiasCorrectionIsFirstOrder) {
  RandomStates random(27);
  const std::vector<ImuSample> samples = RandomSamples(&random, 51, 200);
  const ImuBias bias = random.Bias();
  Preintegration preintegration(bias, {});
  preintegration.Add(samples);
  const auto corrected_error = [&](double size) {
    const ImuBias moved{bias.gyro + size * Vector3d(1, -2, 1), bias.accel + size * Vector3d(-3, 2, 1)};
    Preintegration again(moved, {});
    again.Add(samples);
    const Preintegration::Increments approximate = preintegration.Corrected(moved);
    return (approximate.alpha - again.alpha()).norm() + (approximate.beta - again.beta()).norm() +
           so3::Log(approximate.gamma.transpose() * again.gamma()).norm();
  };
  EXPECT_LT(corrected_error(1e-3), 1e-5);
  EXPECT_NEAR(corrected_error(2e-3) / corrected_error(1e-3), 4.0, 0.3);  // what is left is quadratic
}

TEST(PreintegrationTest, CovarianceIsSymmetricPositive) {
  RandomStates random(28);
  Preintegration preintegration(random.Bias(), {});
  preintegration.Add(RandomSamples(&random, 31, 100));
  const Matrix15d& covariance = preintegration.covariance();
  EXPECT_EQ(covariance, covariance.transpose());
  const double smallest = Eigen::SelfAdjointEigenSolver<Matrix15d>(covariance).eigenvalues().minCoeff();
  EXPECT_GT(smallest, 0);
}

ImuSample At(double seconds, double value) {
  return {SecondsToNs(seconds), Vector3d::Constant(value), Vector3d::Constant(-value)};
}

TEST(ImuBufferTest, SortsAndDropsDuplicates) {
  ImuBuffer buffer(0.5);
  for (const double t : {0.0, 0.02, 0.01, 0.02, 0.03}) {
    EXPECT_TRUE(buffer.Add(At(t, t)).ok());
  }
  ASSERT_EQ(buffer.samples().size(), 4u);
  EXPECT_EQ(buffer.samples()[1].stamp_ns, SecondsToNs(0.01));
  EXPECT_EQ(buffer.statistics().out_of_order, 1);
  EXPECT_EQ(buffer.statistics().duplicates, 1);
}

TEST(ImuBufferTest, InterpolatesToTheMeasurement) {
  ImuBuffer buffer(0.5);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(buffer.Add(At(0.01 * i, i)).ok());
  }
  std::vector<ImuSample> samples;
  ASSERT_TRUE(buffer.Interval(SecondsToNs(0.005), SecondsToNs(0.0325), &samples).ok());
  ASSERT_EQ(samples.size(), 5u);
  EXPECT_NEAR(samples.front().gyro.x(), 0.5, 1e-12);
  EXPECT_NEAR(samples.back().accel.x(), -3.25, 1e-9);
  EXPECT_EQ(samples.back().stamp_ns, SecondsToNs(0.0325));
  ASSERT_TRUE(buffer.Interval(SecondsToNs(0.01), SecondsToNs(0.03), &samples).ok());
  EXPECT_EQ(samples.size(), 3u) << "ends that are measured are not doubled";
}

TEST(ImuBufferTest, SaysWhatIsMissing) {
  ImuBuffer buffer(0.05);
  std::vector<ImuSample> samples;
  EXPECT_FALSE(buffer.Interval(0, 10, &samples).ok());
  ASSERT_TRUE(buffer.Add(At(1.0, 1)).ok());
  ASSERT_TRUE(buffer.Add(At(1.2, 1)).ok());
  EXPECT_NE(buffer.Interval(SecondsToNs(1.1), SecondsToNs(1.3), &samples).message().find("missing 100.0"),
            std::string::npos);
  EXPECT_NE(buffer.Interval(SecondsToNs(0.9), SecondsToNs(1.1), &samples).message().find("starts 100.0"),
            std::string::npos);
  EXPECT_FALSE(buffer.Interval(SecondsToNs(1.1), SecondsToNs(1.1), &samples).ok());
  ASSERT_TRUE(buffer.Interval(SecondsToNs(1.0), SecondsToNs(1.2), &samples).ok());
  EXPECT_EQ(buffer.statistics().gaps, 1);
  EXPECT_NEAR(buffer.statistics().longest_gap_s, 0.2, 1e-9);
}

TEST(ImuBufferTest, RefusesWhatIsNotFiniteOrTooOld) {
  ImuBuffer buffer(0.5);
  EXPECT_FALSE(buffer.Add({0, Vector3d(std::nan(""), 0, 0), Vector3d::Zero()}).ok());
  ASSERT_TRUE(buffer.Add(At(1.0, 1)).ok());
  ASSERT_TRUE(buffer.Add(At(1.1, 1)).ok());
  ASSERT_TRUE(buffer.Add(At(1.2, 1)).ok());
  buffer.DropBefore(SecondsToNs(1.15));
  EXPECT_EQ(buffer.samples().size(), 2u) << "the sample before the stamp is needed to interpolate";
  EXPECT_FALSE(buffer.Add(At(1.05, 1)).ok());
  EXPECT_EQ(buffer.statistics().rejected, 2);
}

TEST(ImuBufferTest, AnEmptyBufferThatDropsStillTakesTheSampleBeforeTheStamp) {
  // An estimator that starts between two samples is told its stamp first and gets the samples afterwards.
  ImuBuffer buffer(0.5);
  buffer.DropBefore(SecondsToNs(1.15));
  EXPECT_TRUE(buffer.Add(At(1.1, 1)).ok());
  EXPECT_TRUE(buffer.Add(At(1.2, 1)).ok());
  std::vector<ImuSample> samples;
  EXPECT_TRUE(buffer.Interval(SecondsToNs(1.15), SecondsToNs(1.2), &samples).ok());
  buffer.DropBefore(SecondsToNs(1.15));
  EXPECT_FALSE(buffer.Add(At(1.12, 1)).ok());
}

}  // namespace
}  // namespace alidade
