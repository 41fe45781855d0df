#include "core/preintegration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "core/imu_buffer.h"
#include "core/imu_propagation.h"
#include "tests/core/imu_samples.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using test::RandomSamples;
using test::RandomStates;

const Vector3d kGravityW = GravityInWorld(test::kGravity);

Preintegration Integrated(std::span<const ImuSample> samples, const ImuBias& bias,
                          const ImuNoise& noise = {}) {
  Preintegration preintegration(bias, noise);
  preintegration.Add(samples);
  return preintegration;
}

Vector15d LocalWithBias(ErrorConvention convention, const NavState& a, const ImuBias& bias_a,
                        const NavState& b, const ImuBias& bias_b) {
  Vector15d xi;
  xi << Local(convention, a, b), bias_b.gyro - bias_a.gyro, bias_b.accel - bias_a.accel;
  return xi;
}

ImuBias Moved(const ImuBias& bias, const Eigen::VectorXd& xi) {
  return {bias.gyro + xi.segment<3>(9), bias.accel + xi.tail<3>()};
}

// GIVEN a fault of one axis at one sample, WHEN a frame falls into the step before it, THEN its noise lies
// in both parts of that step and in no other, and in the direction of that axis alone.
TEST(PreintegrationTest, TheNoiseOfAFaultLiesInTheStepThatEndsAtItsSample) {
  ImuBuffer clean(0.5), faulty(0.5);
  for (int k = 0; k <= 5; ++k) {
    ImuSample sample{SecondsToNs(0.01 * k), Vector3d::Zero(), Vector3d(0, 0, 9.81)};
    ASSERT_TRUE(clean.Add(sample).ok());
    if (k == 2) {
      sample.gyro_fault_density_radps_sqrthz.z() = 0.3;
      sample.accel_fault_density_mps2_sqrthz.z() = 2;
    }
    ASSERT_TRUE(faulty.Add(sample).ok());
  }
  for (const auto& [from_s, to_s, share_s] :
       {std::tuple(0.0, 0.01, 0.0), std::tuple(0.01, 0.016, 0.006), std::tuple(0.016, 0.04, 0.004)}) {
    std::vector<ImuSample> samples, with_fault;
    ASSERT_TRUE(clean.Interval(SecondsToNs(from_s), SecondsToNs(to_s), &samples).ok());
    ASSERT_TRUE(faulty.Interval(SecondsToNs(from_s), SecondsToNs(to_s), &with_fault).ok());
    const Matrix15d more =
        Integrated(with_fault, ImuBias()).covariance() - Integrated(samples, ImuBias()).covariance();
    EXPECT_NEAR(more(2, 2), 0.09 * share_s, 1e-9) << from_s;
    EXPECT_NEAR(more(8, 8), 4 * share_s, 1e-6) << from_s;
    EXPECT_EQ(more.topLeftCorner(2, 2).norm() + more.block(6, 6, 2, 2).norm(), 0) << from_s;
  }
}

// Against integration anew at every moved bias.
TEST(ImuPropagationTest, TransitionIsNumericInEveryConvention) {
  RandomStates random(21);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const std::vector<ImuSample> samples = RandomSamples(&random, 12, 100, trial % 2 == 0 ? 1.5 : 30);
      const NavState start = random.Nav(5);
      const ImuBias bias = random.Bias();
      NavState end = start;
      ImuTransition transition;
      ASSERT_TRUE(PropagateState(Integrated(samples, bias), kGravityW, &end, &transition).ok());
      const auto propagate = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        const ImuBias moved_bias = Moved(bias, xi);
        const NavState moved =
            CarryState(Integrated(samples, moved_bias), Retract(convention, start, Vector9d(xi.head<9>())),
                       moved_bias, kGravityW, nullptr);
        return LocalWithBias(convention, end, bias, moved, moved_bias);
      };
      const Matrix15d analytic =
          InverseImuChartJacobian(convention, end) * transition.phi * ImuChartJacobian(convention, start);
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(propagate, 15), 1e-8), "")
          << ToString(convention);
    }
  }
}

// At a bias other than the integrated one, where the bias enters through the first-order correction.
TEST(CarryStateTest, JacobianIsNumericInEveryConvention) {
  RandomStates random(31);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const Preintegration preintegration = Integrated(RandomSamples(&random, 21, 100), random.Bias());
      const NavState start = random.Nav(5);
      const ImuBias bias = random.Bias();
      Matrix15d phi = Matrix15d::Constant(std::numeric_limits<double>::quiet_NaN());
      const NavState end = CarryState(preintegration, start, bias, kGravityW, &phi);
      const auto carry = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        const NavState moved = CarryState(preintegration, Retract(convention, start, Vector9d(xi.head<9>())),
                                          Moved(bias, xi), kGravityW, nullptr);
        return LocalWithBias(convention, end, bias, moved, Moved(bias, xi));
      };
      const Matrix15d analytic =
          InverseImuChartJacobian(convention, end) * phi * ImuChartJacobian(convention, start);
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(carry, 15), 1e-8), "")
          << ToString(convention);
    }
  }
}

TEST(ImuPropagationTest, RightInvariantTransitionDoesNotDependOnTheState) {
  RandomStates random(22);
  const Preintegration preintegration = Integrated(RandomSamples(&random, 12, 100), {});
  const auto transition_at = [&](const NavState& start) -> Matrix9d {
    Matrix15d phi;
    const NavState end = CarryState(preintegration, start, {}, kGravityW, &phi);
    const Matrix15d invariant = InverseImuChartJacobian(ErrorConvention::kRightInvariant, end) * phi *
                                ImuChartJacobian(ErrorConvention::kRightInvariant, start);
    return invariant.topLeftCorner<9, 9>();
  };
  const Matrix9d first = transition_at(random.Nav(100));
  for (int i = 0; i < 20; ++i) {
    EXPECT_LT((transition_at(random.Nav(100)) - first).norm(), 1e-10);
  }
}

TEST(ImuPropagationTest, StandingStillStays) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 100; ++i) {
    samples.push_back({SecondsToNs(i * 0.01), Vector3d::Zero(), Vector3d(0, 0, test::kGravity)});
  }
  const NavState state = CarryState(Integrated(samples, {}), NavState(), {}, kGravityW, nullptr);
  EXPECT_LT(state.p_WB.norm(), 1e-12);
  EXPECT_LT(state.v_WB.norm(), 1e-12);
}

// The law of total covariance in the increment's frame: noise_root rotates the increment's root and nothing
// else.
TEST(ImuPropagationTest, NoiseIsThatOfTheIncrementInTheWorld) {
  RandomStates random(32);
  const Preintegration preintegration = Integrated(RandomSamples(&random, 12, 100), {});
  const NavState start = random.Nav(5);
  NavState end = start;
  ImuTransition transition;
  ASSERT_TRUE(PropagateState(preintegration, kGravityW, &end, &transition).ok());
  Matrix15d turn = Matrix15d::Identity();
  turn.block<3, 3>(3, 3) = start.R_WB;
  turn.block<3, 3>(6, 6) = start.R_WB;
  const Matrix15d expected = turn * preintegration.covariance() * turn.transpose();
  EXPECT_LT((transition.q() - expected).norm(), 1e-13 * expected.norm());
}

// GIVEN noise or biases that overflow, or a sample that is not finite, THEN a Status and the state as before.
TEST(ImuPropagationTest, NumbersThatOverflowAreADivergedStatus) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  RandomStates random(33);
  const std::vector<ImuSample> samples = RandomSamples(&random, 5, 100);
  const auto with = [&](const Vector3d& gyro, const Vector3d& accel) {
    std::vector<ImuSample> poisoned = samples;
    poisoned[2].gyro = gyro;
    poisoned[2].accel = accel;
    return poisoned;
  };
  const std::vector<Preintegration> hostile = {
      Integrated(with({nan, 0, 0}, {0, 0, 9}), {}),
      Integrated(with({0, 0, 0}, {0, nan, 9}), {}),
      Integrated(with({0, 0, 0}, {0, 1e200, 0}), {}),
      Integrated(with({1e200, 0, 0}, {0, 0, 9}), {}),
      Integrated(samples, {Vector3d(0, 0, 1e308), Vector3d::Zero()}),
      Integrated(samples, {Vector3d::Zero(), Vector3d(0, nan, 0)}),
      Integrated(samples, {}, {1e300, 1e-3, 1e-5, 1e-4}),
      Integrated(samples, {}, {1e-3, 1e-3, 1e-5, nan}),
  };
  for (size_t k = 0; k < hostile.size(); ++k) {
    NavState state;
    ImuTransition transition;
    EXPECT_EQ(PropagateState(hostile[k], kGravityW, &state, &transition).code(), StatusCode::kDiverged) << k;
    EXPECT_EQ(state.p_WB, NavState().p_WB);
    EXPECT_EQ(transition.phi, Matrix15d::Identity());
    Matrix15d root;
    EXPECT_FALSE(hostile[k].Whitening(&root)) << k;
  }
}

TEST(PreintegrationTest, WithoutStepsItIsTheIdentityAndHasNoWhitening) {
  const ImuSample alone{0, Vector3d(1, 2, 3), Vector3d(4, 5, 6)};
  for (const std::span<const ImuSample> samples : {std::span<const ImuSample>(), std::span(&alone, 1)}) {
    const Preintegration preintegration = Integrated(samples, {});
    EXPECT_EQ(preintegration.duration_s(), 0);
    EXPECT_EQ(preintegration.covariance(), Matrix15d::Zero());
    Matrix15d root;
    EXPECT_TRUE(preintegration.NoiseRoot(&root));
    EXPECT_EQ(root, Matrix15d::Zero());
    EXPECT_FALSE(preintegration.Whitening(&root));
  }
}

TEST(PreintegrationTest, WhiteningAndRootAreThoseOfTheCovariance) {
  RandomStates random(34);
  for (const int count : {2, 3, 21, 2001}) {
    const Preintegration preintegration = Integrated(RandomSamples(&random, count, 200), random.Bias());
    Matrix15d root;
    Matrix15d whitening;
    ASSERT_TRUE(preintegration.NoiseRoot(&root));
    ASSERT_TRUE(preintegration.Whitening(&whitening));
    EXPECT_LT((root * root.transpose() - preintegration.covariance()).norm(),
              1e-13 * preintegration.covariance().norm());
    EXPECT_LT((whitening * preintegration.covariance() * whitening.transpose() - Matrix15d::Identity())
                  .cwiseAbs()
                  .maxCoeff(),
              1e-9)
        << count;
  }
  const std::vector<ImuSample> samples = RandomSamples(&random, 5, 200);
  Matrix15d whitening;
  EXPECT_FALSE(Integrated(samples, {}, {1e-3, 1e-2, 0, 1e-4}).Whitening(&whitening)) << "a bias without walk";
}

TEST(PreintegrationModelTest, VanishesOnTheCarriedState) {
  RandomStates random(25);
  const Preintegration preintegration = Integrated(RandomSamples(&random, 41, 400), random.Bias());
  const NavState start = random.Nav(3);
  const ImuBias bias = random.Bias();
  const NavState end = CarryState(preintegration, start, bias, kGravityW, nullptr);
  Vector15d residual;
  PreintegrationModel{&preintegration, kGravityW}.Evaluate(start, bias, end, bias, &residual, nullptr,
                                                           nullptr);
  EXPECT_LT(residual.norm(), 1e-13);
}

TEST(PreintegrationModelTest, ResidualJacobiansAreNumericInEveryConvention) {
  RandomStates random(26);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const Preintegration preintegration = Integrated(RandomSamples(&random, 21, 100), random.Bias());
      const PreintegrationModel model{&preintegration, kGravityW};
      const NavState i = random.Nav(3);
      const NavState j = random.Nav(3);
      const ImuBias bias_i = random.Bias();
      const ImuBias bias_j = random.Bias();
      Vector15d residual;
      Matrix15d jacobian_i = Matrix15d::Constant(std::numeric_limits<double>::quiet_NaN());
      Matrix15d jacobian_j = jacobian_i;
      model.Evaluate(i, bias_i, j, bias_j, &residual, &jacobian_i, &jacobian_j);
      Vector15d alone;
      model.Evaluate(i, bias_i, j, bias_j, &alone, nullptr, nullptr);
      EXPECT_EQ(residual, alone);
      const auto move_i = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        Vector15d r;
        model.Evaluate(Retract(convention, i, Vector9d(xi.head<9>())), Moved(bias_i, xi), j, bias_j, &r,
                       nullptr, nullptr);
        return r;
      };
      const auto move_j = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        Vector15d r;
        model.Evaluate(i, bias_i, Retract(convention, j, Vector9d(xi.head<9>())), Moved(bias_j, xi), &r,
                       nullptr, nullptr);
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
  const Preintegration preintegration = Integrated(samples, bias);
  const auto corrected_error = [&](double size) {
    const ImuBias moved{bias.gyro + size * Vector3d(1, -2, 1), bias.accel + size * Vector3d(-3, 2, 1)};
    const ImuMotion again = Integrated(samples, moved).motion();
    const ImuMotion approximate = preintegration.Corrected(moved);
    return (approximate.alpha - again.alpha).norm() + (approximate.beta - again.beta).norm() +
           so3::Log(approximate.gamma.transpose() * again.gamma).norm();
  };
  EXPECT_LT(corrected_error(1e-3), 1e-5);
  EXPECT_NEAR(corrected_error(2e-3) / corrected_error(1e-3), 4.0, 0.3);  // what is left is quadratic
}

}  // namespace
}  // namespace alidade
