#include "core/imu_increment.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/imu_step.h"
#include "core/preintegration.h"
#include "tests/core/imu_samples.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using test::RandomStates;

Vector9d Error(const ImuMotion& nominal, const ImuMotion& moved) {
  Vector9d error;
  error << so3::Log(nominal.gamma.transpose() * moved.gamma), moved.alpha - nominal.alpha,
      moved.beta - nominal.beta;
  return error;
}

ImuIncrement Integrate(std::span<const ImuSample> samples, const ImuBias& bias, const ImuNoise& noise) {
  Preintegration interval(bias, noise);
  interval.Add(samples);
  return {interval.motion(), interval.bias_jacobian(), interval.covariance()};
}

double Relative(const Matrix15d& a, const Matrix15d& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

// GIVEN constant rate and specific force, THEN one step of any length is the limit of many.
TEST(ImuIncrementTest, OneStepOfConstantMotionIsExact) {
  RandomStates random(20);
  for (const double rate : {0.0, 0.5, 5.0, 40.0}) {
    const Vector3d omega = random.Vector(rate);
    const Vector3d accel = random.Vector(20);
    ImuMotion fine;
    for (int k = 0; k < 1000; ++k) {
      fine = fine * StepIncrement(omega, accel, 1e-4, {}).motion;
    }
    EXPECT_LT(Error(fine, StepIncrement(omega, accel, 0.1, {}).motion).norm(), 1e-11) << rate << " rad/s";
  }
}

// GIVEN an interval cut in two, THEN the increments of the parts compose to that of the whole.
TEST(ImuIncrementTest, IncrementsCompose) {
  RandomStates random(21);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<ImuSample> samples = test::RandomSamples(&random, 31, 100, trial % 2 == 0 ? 1.5 : 30);
    SetCurvatures(samples);
    const ImuBias bias = random.Bias();
    const ImuIncrement whole = Integrate(samples, bias, {});
    for (const size_t cut : {1u, 11u, 29u}) {
      ImuIncrement composed = Integrate(std::span(samples).first(cut + 1), bias, {});
      composed.Append(Integrate(std::span(samples).subspan(cut), bias, {}));
      EXPECT_LT(Error(whole.motion, composed.motion).norm(), 1e-12);
      EXPECT_NEAR(composed.motion.duration_s, whole.motion.duration_s, 1e-12);
      EXPECT_LT((composed.bias_jacobian - whole.bias_jacobian).norm(), 1e-12 * whole.bias_jacobian.norm());
      EXPECT_LT(Relative(composed.covariance, whole.covariance), 1e-12);
    }
  }
}

/// The motion between the samples of the IMU: fine steps with white noise and walking biases.
Vector15d DrawError(std::span<const ImuSample> samples, const ImuNoise& noise, const ImuMotion& nominal,
                    RandomStream* draws) {
  constexpr int kPieces = 12;
  ImuMotion motion;
  ImuBias bias;
  for (size_t k = 0; k + 1 < samples.size(); ++k) {
    const double dt = SecondsBetween(samples[k].stamp_ns, samples[k + 1].stamp_ns) / kPieces;
    const double root = std::sqrt(dt);
    for (int piece = 0; piece < kPieces; ++piece) {
      const Vector3d gyro_step = noise.gyro_random_walk_radps2_sqrthz * root * draws->Normal3();
      const Vector3d accel_step = noise.accel_random_walk_mps3_sqrthz * root * draws->Normal3();
      const double along = (piece + 0.5) / kPieces;
      const ImuSample reading = {0, samples[k].gyro + along * (samples[k + 1].gyro - samples[k].gyro),
                                 samples[k].accel + along * (samples[k + 1].accel - samples[k].accel)};
      const Vector3d omega = reading.gyro - bias.gyro - 0.5 * gyro_step -
                             noise.gyro_noise_density_radps_sqrthz / root * draws->Normal3();
      const Vector3d accel = reading.accel - bias.accel - 0.5 * accel_step -
                             noise.accel_noise_density_mps2_sqrthz / root * draws->Normal3();
      motion = motion * StepIncrement(omega, accel, dt, noise).motion;
      bias.gyro += gyro_step;
      bias.accel += accel_step;
    }
  }
  Vector15d error;
  error << Error(nominal, motion), bias.gyro, bias.accel;
  return error;
}

// All four noises at once, over one step and over many: the terms within a step (position against velocity,
// bias against attitude) count most over one.
TEST(ImuIncrementTest, CovarianceMatchesMonteCarlo) {
  RandomStates random(22);
  const ImuNoise noise{1e-2, 5e-2, 3e-2, 1e-1};
  constexpr int kDraws = 4000;
  for (const int samples_in_interval : {2, 9}) {
    const std::vector<ImuSample> samples = test::RandomSamples(&random, samples_in_interval, 50);
    const ImuIncrement increment = Integrate(samples, {}, noise);
    RandomStream draws(23, "noise");
    Matrix15d sum = Matrix15d::Zero();
    for (int draw = 0; draw < kDraws; ++draw) {
      const Vector15d error = DrawError(samples, noise, increment.motion, &draws);
      sum += error * error.transpose() / kDraws;
    }
    const Eigen::LLT<Matrix15d> factor(increment.covariance);
    ASSERT_EQ(factor.info(), Eigen::Success);
    const Matrix15d half = factor.matrixL().solve(sum);
    const Matrix15d whitened = factor.matrixL().solve(half.transpose());
    // 4000 draws determine a variance to 2.2 %, the worst of 120 entries to about three times that.
    EXPECT_LT((whitened - Matrix15d::Identity()).cwiseAbs().maxCoeff(), 0.1) << samples_in_interval;
  }
}

// GIVEN noises that are zero, far apart, or over a long step, THEN the covariance of a step stays positive
// semi-definite: it is an integral of squares, with no term left out.
TEST(ImuIncrementTest, CovarianceIsPositiveSemiDefiniteForAnyNoise) {
  RandomStates random(24);
  for (const ImuNoise& noise :
       {ImuNoise{}, ImuNoise{0, 0, 1e-2, 1e-2}, ImuNoise{1e-6, 1e-6, 1e-1, 1}, ImuNoise{1e-2, 1e-1, 0, 0}}) {
    for (const double dt : {1e-4, 1e-2, 1.0, 5.0}) {
      const Matrix15d q = StepIncrement(random.Vector(3), random.Vector(30), dt, noise).covariance;
      EXPECT_LE((q - q.transpose()).norm(), 1e-15 * q.norm());
      const Eigen::VectorXd scale =
          (q.diagonal().array() > 0).select(q.diagonal().cwiseSqrt().cwiseInverse(), 0);
      const Matrix15d correlation = scale.asDiagonal() * q * scale.asDiagonal();
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix15d>(correlation).eigenvalues().minCoeff(), -1e-12) << dt;
    }
  }
}

// GIVEN white noise of single axes, THEN each moves attitude and velocity in its own direction, and equal
// ones of all axes together have the covariance of the sensor's noise.
TEST(ImuIncrementTest, NoiseOfSingleAxesAddsUpToThatOfAll) {
  RandomStates random(25);
  for (const double dt : {1e-3, 1e-2, 0.2}) {
    const Vector3d omega = random.Vector(3);
    const Vector3d accel = random.Vector(30);
    const Eigen::Matrix3d middle = so3::Exp(0.5 * dt * omega);
    Matrix15d sum = Matrix15d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d unit = Vector3d::Unit(axis);
      Matrix15d gyro = Matrix15d::Zero(), force = Matrix15d::Zero();
      AddAxisNoise(omega, accel, dt, 0.2 * unit, Vector3d::Zero(), &gyro);
      AddAxisNoise(omega, accel, dt, Vector3d::Zero(), 0.7 * unit, &force);
      const Vector3d turned = middle.transpose() * unit;
      const Vector3d pushed = middle * unit;
      EXPECT_LT((gyro.topLeftCorner<3, 3>() - 0.04 * dt * turned * turned.transpose()).norm(), 1e-15);
      EXPECT_LT((force.block<3, 3>(6, 6) - 0.49 * dt * pushed * pushed.transpose()).norm(), 1e-15);
      EXPECT_EQ(force.topRows<3>().norm(), 0);
      sum += gyro + force;
    }
    const Matrix15d all = StepIncrement(omega, accel, dt, ImuNoise{0.2, 0.7, 0, 0}).covariance;
    EXPECT_LT((sum - all).norm(), 1e-13 * all.norm()) << dt;
  }
}

}  // namespace
}  // namespace alidade
