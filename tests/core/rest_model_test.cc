#include "core/rest_model.h"

#include <gtest/gtest.h>

#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

TEST(RestModelTest, VanishesOnARigAtRest) {
  const NavState state{so3::Exp({0.1, 0.2, 2.0}), {1, 2, 3}, Eigen::Vector3d::Zero()};
  const ImuBias bias{{0.01, -0.02, 0.003}, {0.1, 0.2, 0.3}};
  Vector6d residual;
  RestModel{{bias.gyro, bias.gyro}, {0.1, -0.2, 0.05}}.Evaluate(state, bias, &residual, nullptr);
  EXPECT_EQ(residual.norm(), 0);
}

TEST(RestModelTest, GivenABodyThatTurnsAboutItsCameraThenTheVelocityOfTheCameraVanishes) {
  const Eigen::Vector3d p_BC(0.1, -0.2, 0.05);
  const Eigen::Vector3d rate(0.4, 0.1, -0.6);
  NavState state{so3::Exp({0.1, 0.2, 2.0}), {1, 2, 3}, Eigen::Vector3d::Zero()};
  state.v_WB = -state.R_WB * rate.cross(p_BC);
  const ImuBias bias{{0.01, -0.02, 0.003}, {0.1, 0.2, 0.3}};
  Vector6d residual;
  RestModel{{bias.gyro, rate + bias.gyro}, p_BC}.Evaluate(state, bias, &residual, nullptr);
  EXPECT_LT(residual.norm(), 1e-15);
}

TEST(RestModelTest, JacobianAgreesWithCentralDifferencesInAllConventions) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::RandomStates random(seed);
    const NavState state{random.Rotation(), random.Vector(5), random.Vector(2)};
    const ImuBias bias = random.Bias();
    const RestModel model{{random.Vector(0.1), random.Vector(1)}, random.Vector(0.3)};
    Vector6d residual;
    RestModel::Jacobian jacobian;
    model.Evaluate(state, bias, &residual, &jacobian);
    Vector6d alone;
    model.Evaluate(state, bias, &alone, nullptr);
    EXPECT_EQ(residual, alone);
    for (const ErrorConvention convention : test::kAllConventions) {
      const auto displaced = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        const ImuBias moved{bias.gyro + xi.segment<3>(9), bias.accel + xi.segment<3>(12)};
        Vector6d r;
        model.Evaluate(Retract(convention, state, xi.head<9>()), moved, &r, nullptr);
        return r;
      };
      EXPECT_EQ(test::CompareJacobians(jacobian * ImuChartJacobian(convention, state),
                                       test::NumericJacobian(displaced, 15), 1e-8),
                "")
          << ToString(convention) << " seed " << seed;
    }
  }
}

TEST(RestModelTest, WhitensWithTheConfiguredDeviationsAndLeavesATurningRigItsRate) {
  VisionConfig vision;
  vision.rest_velocity_std_mps = 0.5;
  vision.rest_rate_std_radps = 0.1;
  const NavState state{Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), {1, 2, 3}};
  const ImuBias bias{{0.3, 0.2, 0.1}, Eigen::Vector3d::Zero()};
  const RestRates rates{{0.1, 0.1, 0.1}, bias.gyro};
  Vector6d residual;
  RestModel::Jacobian jacobian;
  MakeRestMeasurement({true, true}, 5, rates, Eigen::Vector3d::Zero(), vision)
      .Evaluate(state, bias, &residual, &jacobian);
  EXPECT_LT((residual - (Vector6d() << 2, 4, 6, 2, 1, 0).finished()).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(jacobian(0, 6), 2);
  EXPECT_DOUBLE_EQ(jacobian(3, 9), 10);
  MakeRestMeasurement({true, false}, 5, rates, Eigen::Vector3d::Zero(), vision)
      .Evaluate(state, bias, &residual, &jacobian);
  EXPECT_EQ(residual.tail<3>().norm(), 0);
  EXPECT_EQ(jacobian.bottomRows<3>().norm(), 0);
}

// GIVEN four times the flow of a rig at rest THEN its velocity is zero to four times the configured
// deviation.
TEST(RestModelTest, FlowThatIsMoreThanNoiseMakesTheVelocityLessCertain) {
  const VisionConfig vision;
  const auto at_rest = MakeRestMeasurement({true, true, 2}, 5, {}, Eigen::Vector3d::Zero(), vision);
  const auto slow = MakeRestMeasurement({true, true, 10}, 5, {}, Eigen::Vector3d::Zero(), vision);
  EXPECT_DOUBLE_EQ(at_rest.sqrt_information[0] * vision.rest_velocity_std_mps, 1);
  EXPECT_DOUBLE_EQ(at_rest.sqrt_information[0], 4 * slow.sqrt_information[0]);
  EXPECT_DOUBLE_EQ(at_rest.sqrt_information[3], 4 * slow.sqrt_information[3]);
}

// GIVEN scenery so far that the flow leaves a speed above the configured deviation THEN that is the
// velocity's deviation, and the rate keeps its own.
TEST(RestModelTest, FarSceneryHidesASpeed) {
  const VisionConfig vision;
  RestVerdict verdict{true, true};
  verdict.speed_per_depth = 0.002;
  const auto near = MakeRestMeasurement(verdict, 5, {}, Eigen::Vector3d::Zero(), vision);
  const auto far = MakeRestMeasurement(verdict, 50, {}, Eigen::Vector3d::Zero(), vision);
  EXPECT_DOUBLE_EQ(near.sqrt_information[0] * vision.rest_velocity_std_mps, 1);
  EXPECT_DOUBLE_EQ(far.sqrt_information[0] * 0.1, 1);
  EXPECT_DOUBLE_EQ(far.sqrt_information[3], near.sqrt_information[3]);
}

}  // namespace
}  // namespace alidade
