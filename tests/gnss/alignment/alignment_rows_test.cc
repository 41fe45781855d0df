#include <gtest/gtest.h>

#include <vector>

#include "core/error_convention.h"
#include "core/random.h"
#include "gnss/alignment/antenna_at_epoch.h"
#include "gnss/alignment/fix_rows.h"
#include "tests/support/jacobian_checker.h"

// The rows of the alignments' least squares against numeric differences.

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Matrix3d RandomMatrix(RandomStream* random) {
  Matrix3d matrix;
  for (double& entry : matrix.reshaped()) {
    entry = random->Normal();
  }
  return matrix;
}

TEST(FixRowsTest, JacobianAgainstDifferences) {
  RandomStream random(1, "fix rows");
  for (int i = 0; i < 5; ++i) {
    FixGuess guess;
    guess.transform = {random.Uniform(-3, 3), 10 * random.Normal3()};
    guess.dv_W = random.Normal3();
    FixPoint point;
    point.p_WA = 10 * random.Normal3();
    point.p_NA = 10 * random.Normal3();
    point.since_newest_s = random.Uniform(-20, -1);
    point.sqrt_information = RandomMatrix(&random);
    const auto residual = [&](const VectorXd& step) -> VectorXd {
      FixGuess moved = guess;
      moved.Move(step);
      return moved.Residual(point);
    };
    EXPECT_EQ(
        test::CompareJacobians(MatrixXd(guess.Jacobian(point)), test::NumericJacobian(residual, 7), 1e-9),
        "");
  }
}

/// A second of turning and shaking.
Preintegration MakeInterval(const ImuBias& bias, RandomStream* random) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 100; ++k) {
    samples.push_back({SecondsToNs(0.01 * k), random->Normal3(), Vector3d(0, 0, 9.81) + random->Normal3()});
  }
  Preintegration interval(bias, ImuNoise());
  interval.Add(samples);
  return interval;
}

// GIVEN an antenna at the first epoch or a second later, THEN position and velocity there change with state
// and bias of the first epoch as Jacobian and chain give it.
TEST(AntennaAtEpochTest, JacobiansAgainstDifferences) {
  RandomStream random(2, "antenna at an epoch");
  const Vector3d gravity_W = GravityInWorld(9.81);
  for (const bool carried : {false, true}) {
    // The frame's origin is the Earth's centre, so that no digits are lost.
    const AntennaMount mount{{Vector3d::Zero(), so3::Exp(random.Normal3())}, Vector3d(0.4, -0.3, 1.1)};
    const NavState nav = {so3::Exp(random.Normal3()), random.Normal3(), random.Normal3()};
    const ImuBias bias = {0.01 * random.Normal3(), 0.1 * random.Normal3()};
    const Vector3d gyro_radps = random.Normal3();
    const Preintegration interval = MakeInterval(bias, &random);
    const auto antenna = [&](const VectorXd& zeta) {
      const NavState moved = Retract(ErrorConvention::kSo3xRn, nav, Vector9d(zeta.head<9>()));
      const ImuBias moved_bias = {bias.gyro + zeta.segment<3>(9), bias.accel + zeta.tail<3>()};
      return PredictAntenna(mount, carried ? &interval : nullptr, gravity_W, moved, moved_bias, gyro_radps);
    };
    const AntennaAtEpoch at = antenna(VectorXd::Zero(15));
    const auto position = [&](const VectorXd& zeta) -> VectorXd { return antenna(zeta).position_E; };
    const auto velocity = [&](const VectorXd& zeta) -> VectorXd { return antenna(zeta).velocity_E; };
    EXPECT_EQ(test::CompareJacobians(MatrixXd(at.position_jacobian * at.chain),
                                     test::NumericJacobian(position, 15), 1e-7),
              "")
        << carried;
    EXPECT_EQ(test::CompareJacobians(MatrixXd(at.velocity_jacobian * at.chain),
                                     test::NumericJacobian(velocity, 15), 1e-7),
              "")
        << carried;
  }
}

}  // namespace
}  // namespace alidade
