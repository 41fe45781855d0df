#include "core/yaw_shift.h"

#include <gtest/gtest.h>

#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using test::RandomStates;

YawShift RandomTransform(RandomStates* random) {
  return {random->Uniform(-3, 3), random->Vector(100)};
}

TEST(YawShiftTest, GIVEN_a_quarter_turn_THEN_east_becomes_north_and_the_vertical_stays) {
  const YawShift transform{M_PI / 2, Vector3d(10, 20, 30)};
  const NavState state_N = transform * NavState{Eigen::Matrix3d::Identity(), {1, 0, 2}, {3, 0, 4}};
  EXPECT_TRUE(state_N.p_WB.isApprox(Vector3d(10, 21, 32), 1e-14));
  EXPECT_TRUE(state_N.v_WB.isApprox(Vector3d(0, 3, 4), 1e-14));
  EXPECT_TRUE(state_N.R_WB.col(0).isApprox(Vector3d::UnitY(), 1e-14));
  EXPECT_TRUE(state_N.R_WB.col(2).isApprox(Vector3d::UnitZ(), 1e-14));
}

TEST(YawShiftTest, GIVEN_a_state_THEN_its_pose_is_transformed_alike) {
  RandomStates random(2);
  const YawShift transform = RandomTransform(&random);
  const NavState state = random.Nav(50);
  const Pose pose_N = transform * state.T_WB();
  EXPECT_EQ(pose_N.rotation, (transform * state).R_WB);
  EXPECT_EQ(pose_N.translation, (transform * state).p_WB);
}

TEST(YawShiftTest, GIVEN_an_estimate_THEN_errors_along_the_axes_turn_and_those_of_the_body_stay) {
  const YawShift quarter{M_PI / 2, Vector3d(10, 20, 30)};
  RandomStates random(3);
  NavEstimate estimate{7, random.Nav(50), random.Bias(), Matrix15d::Zero()};
  // Variances of dp along x and of dv along y, of roll and of a bias; dp with roll.
  estimate.covariance(3, 3) = 4;
  estimate.covariance(7, 7) = 9;
  estimate.covariance(0, 0) = 1;
  estimate.covariance(10, 10) = 2;
  estimate.covariance(3, 0) = estimate.covariance(0, 3) = 0.5;
  const NavEstimate moved = quarter * estimate;
  EXPECT_EQ(moved.stamp_ns, 7);
  EXPECT_EQ(moved.nav.p_WB, (quarter * estimate.nav).p_WB);
  EXPECT_EQ(moved.bias.gyro, estimate.bias.gyro);
  Matrix15d expected = Matrix15d::Zero();
  expected(4, 4) = 4;
  expected(6, 6) = 9;
  expected(0, 0) = 1;
  expected(10, 10) = 2;
  expected(4, 0) = expected(0, 4) = 0.5;
  EXPECT_TRUE(moved.covariance.isApprox(expected, 1e-14)) << moved.covariance;
}

TEST(YawShiftTest, GIVEN_random_states_THEN_the_parameter_jacobian_is_that_of_central_differences) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomStates random(seed);
    const YawShift transform = RandomTransform(&random);
    const NavState state = random.Nav(50);
    const NavState state_N = transform * state;
    for (const ErrorConvention convention : test::kAllConventions) {
      const auto displaced = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
        const YawShift other{transform.yaw_rad + d[0], transform.p_NW + d.tail<3>()};
        return Local(convention, state_N, other * state);
      };
      const Eigen::MatrixXd analytic =
          InverseChartJacobian(convention, state_N) * transform.ParameterJacobian(state_N);
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(displaced, 4), 1e-8), "")
          << ToString(convention) << " " << seed;
    }
  }
}

TEST(YawShiftTest, GIVEN_random_states_THEN_the_state_jacobian_is_that_of_central_differences) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomStates random(seed);
    const YawShift transform = RandomTransform(&random);
    const NavState state = random.Nav(50);
    const NavState state_N = transform * state;
    for (const ErrorConvention convention : test::kAllConventions) {
      const auto displaced = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        return Local(convention, state_N, transform * Retract(convention, state, Vector9d(xi)));
      };
      const Eigen::MatrixXd analytic = InverseChartJacobian(convention, state_N) * transform.StateJacobian() *
                                       ChartJacobian(convention, state);
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(displaced, 9), 1e-8), "")
          << ToString(convention) << " " << seed;
    }
  }
}

}  // namespace
}  // namespace alidade
