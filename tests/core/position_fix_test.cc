#include "core/position_fix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/robust.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d RandomCovariance(test::RandomStates* random) {
  const Matrix3d root = Matrix3d::NullaryExpr([&] { return random->Uniform(-1, 1); });
  return root * root.transpose() + 0.1 * Matrix3d::Identity();
}

TEST(PositionFixTest, GIVEN_a_turned_body_THEN_the_fix_of_its_lever_arm_leaves_no_residual) {
  const NavState state{so3::Exp({0, 0, M_PI / 2}), {1, 2, 3}, {4, 5, 6}};
  // A quarter turn to the left carries x to y: A is half a metre to the west of B.
  const PositionFixModel model{{0, 0.5, 0.25}, {0.5, 2, 3.25}};
  Vector3d residual;
  model.Evaluate(state, &residual, nullptr);
  EXPECT_LT(residual.norm(), 1e-15);
}

TEST(PositionFixTest, GIVEN_random_states_THEN_the_Jacobian_is_that_of_differences_in_all_conventions) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    test::RandomStates random(seed);
    const NavState state = random.Nav(50);
    const PositionFix fix{0, 0, random.Vector(50), RandomCovariance(&random)};
    const Result<FixMeasurement> measurement = MakeFixMeasurement({}, random.Vector(2), fix);
    ASSERT_TRUE(measurement.ok()) << measurement.message();
    Vector3d residual;
    PositionFixModel::Jacobian jacobian;
    measurement->Evaluate(state, &residual, &jacobian);
    Vector3d alone;
    measurement->Evaluate(state, &alone, nullptr);
    EXPECT_EQ(residual, alone);
    for (const ErrorConvention convention : test::kAllConventions) {
      const auto displaced = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        Vector3d r;
        measurement->Evaluate(Retract(convention, state, xi.head<9>()), &r, nullptr);
        return r;
      };
      EXPECT_EQ(test::CompareJacobians(jacobian * ImuChartJacobian(convention, state),
                                       test::NumericJacobian(displaced, 15), 1e-7),
                "")
          << ToString(convention) << " seed " << seed;
    }
  }
}

TEST(PositionFixTest, GIVEN_a_scale_and_a_floor_THEN_the_residual_is_whitened_by_the_assumed_covariance) {
  test::RandomStates random(3);
  FixConfig config;
  config.std_scale = 2;
  config.std_floor_m = 0.3;
  const PositionFix fix{0, 0, random.Vector(5), RandomCovariance(&random)};
  const Result<FixMeasurement> measurement = MakeFixMeasurement(config, Vector3d::Zero(), fix);
  ASSERT_TRUE(measurement.ok());
  const Matrix3d assumed = 4 * fix.covariance + 0.09 * Matrix3d::Identity();
  const Matrix3d information = measurement->sqrt_information.transpose() * measurement->sqrt_information;
  EXPECT_TRUE((information * assumed).isIdentity(1e-12));
  const NavState state = random.Nav(5);
  Vector3d residual;
  measurement->Evaluate(state, &residual, nullptr);
  const Vector3d plain = state.p_WB - fix.p_A;
  EXPECT_NEAR(residual.squaredNorm(), plain.dot(assumed.inverse() * plain), 1e-9);
}

TEST(PositionFixTest, GIVEN_numbers_that_are_no_measurement_THEN_they_are_refused) {
  const PositionFix fine{1'500'000'000, 0, Vector3d::Ones(), Matrix3d::Identity()};
  EXPECT_TRUE(MakeFixMeasurement({}, Vector3d::Zero(), fine).ok());
  PositionFix fix = fine;
  fix.p_A.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(MakeFixMeasurement({}, Vector3d::Zero(), fix).status().code(), StatusCode::kInput);
  fix = fine;
  fix.covariance(0, 1) = 0.5;
  EXPECT_EQ(MakeFixMeasurement({}, Vector3d::Zero(), fix).status().code(), StatusCode::kInput);
  fix.covariance(1, 0) = 0.5;
  EXPECT_TRUE(MakeFixMeasurement({}, Vector3d::Zero(), fix).ok());
  fix.covariance(2, 2) = -1e-3;
  const Status status = MakeFixMeasurement({}, Vector3d::Zero(), fix).status();
  EXPECT_EQ(status.code(), StatusCode::kInput);
  EXPECT_NE(status.message().find("1.500000000 s"), std::string::npos) << status.message();
}

TEST(PositionFixTest, GIVEN_a_configuration_THEN_the_gate_is_its_quantile_of_three_rows) {
  FixConfig config;
  config.gate_probability = 0.9;
  config.max_refused_run = 1;
  config.robust_kernel = RobustKernel::kNone;
  MeasurementGate gate = MakeFixGate(config);
  const double threshold = ChiSquareQuantile(3, 0.9);
  EXPECT_EQ(gate.Weigh(0.99 * threshold), 1);
  EXPECT_EQ(gate.Weigh(1.25 * threshold), 0);
  EXPECT_DOUBLE_EQ(gate.Weigh(1.25 * threshold), 0.8);
}

TEST(PositionFixTest, GIVEN_a_lever_arm_THEN_its_rows_are_the_differences) {
  const Matrix3d covariance = Vector3d(4, 1, 9).asDiagonal();
  NavState state;
  state.R_WB = so3::Exp(Vector3d(0.3, -0.8, 0.5));
  FixMeasurement measurement =
      *MakeFixMeasurement({}, Vector3d(0.1, 0.2, 0.3), {0, 0, Vector3d::Ones(), covariance});
  const Matrix3d rows = measurement.LeverArmJacobian(state);
  Vector3d before;
  Vector3d after;
  measurement.Evaluate(state, &before, nullptr);
  measurement.model.p_BA += Vector3d(0.5, -1, 2);
  measurement.Evaluate(state, &after, nullptr);
  EXPECT_LT((after - before - rows * Vector3d(0.5, -1, 2)).norm(), 1e-12);
}

}  // namespace
}  // namespace alidade
