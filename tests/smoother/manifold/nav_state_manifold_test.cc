#include "smoother/manifold/nav_state_manifold.h"

#include <ceres/manifold_test_utils.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using test::CompareJacobians;
using test::kAllConventions;
using test::RandomStates;
using AmbientVector = Eigen::Matrix<double, kNavAmbientSize, 1>;
using PlusMatrix = Eigen::Matrix<double, kNavAmbientSize, kNavTangentSize, Eigen::RowMajor>;
using MinusMatrix = Eigen::Matrix<double, kNavTangentSize, kNavAmbientSize, Eigen::RowMajor>;

AmbientVector Block(const NavState& state) {
  AmbientVector block;
  PackNavState(state, block.data());
  return block;
}

class NavStateManifoldTest : public testing::TestWithParam<ErrorConvention> {};

TEST_P(NavStateManifoldTest, ObeysEveryLawOfACeresManifold) {
  RandomStates random(11);
  for (int trial = 0; trial < 20; ++trial) {
    const NavStateManifold manifold = trial % 2 == 0
                                          ? NavStateManifold(GetParam())
                                          : NavStateManifold(GetParam(), random.Vector(8), random.Vector(8));
    const Eigen::VectorXd x = Block(random.Nav(5));
    const Eigen::VectorXd y = Block(random.Nav(5));
    Eigen::VectorXd delta(kNavTangentSize);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(kNavTangentSize);
    delta << random.Vector(0.8), random.Vector(3), random.Vector(3);
    constexpr double kTolerance = 1e-9;
    EXPECT_THAT(manifold, ceres::XPlusZeroIsXAt(x, kTolerance));
    EXPECT_THAT(manifold, ceres::XMinusXIsZeroAt(x, kTolerance));
    EXPECT_THAT(manifold, ceres::MinusPlusIsIdentityAt(x, delta, kTolerance));
    EXPECT_THAT(manifold, ceres::MinusPlusIsIdentityAt(x, zero, kTolerance));
    EXPECT_THAT(manifold, ceres::PlusMinusIsIdentityAt(x, x, kTolerance));
    EXPECT_THAT(manifold, ceres::HasCorrectPlusJacobianAt(x, kTolerance));
    EXPECT_THAT(manifold, ceres::HasCorrectMinusJacobianAt(x, kTolerance));
    EXPECT_THAT(manifold, ceres::MinusPlusJacobianIsIdentityAt(x, kTolerance));
    EXPECT_THAT(manifold, ceres::HasCorrectRightMultiplyByPlusJacobianAt(x, kTolerance));
    // PlusMinus(x, y) may give the other quaternion of the same rotation: compare up to that sign.
    Eigen::VectorXd y_minus_x(kNavTangentSize);
    AmbientVector back;
    ASSERT_TRUE(manifold.Minus(y.data(), x.data(), y_minus_x.data()));
    ASSERT_TRUE(manifold.Plus(x.data(), y_minus_x.data(), back.data()));
    if (back.head<4>().dot(y.head<4>()) < 0) {
      back.head<4>() = -back.head<4>();
    }
    EXPECT_LT((back - y).norm(), 1e-9);
  }
}

TEST_P(NavStateManifoldTest, TheLiftIsTheChartJacobianTimesTheMinusJacobian) {
  RandomStates random(12);
  const NavStateManifold manifold(GetParam());
  for (int trial = 0; trial < 20; ++trial) {
    const NavState state = random.Nav(5);
    const AmbientVector x = Block(state);
    MinusMatrix minus;
    ASSERT_TRUE(manifold.MinusJacobian(x.data(), minus.data()));
    MinusMatrix lift = MinusMatrix::Zero();
    lift.topLeftCorner<3, 4>() = RotationLift(x.data());
    lift.bottomRightCorner<6, 6>().setIdentity();
    EXPECT_EQ(CompareJacobians(lift, ChartJacobian(GetParam(), state) * minus, 1e-12), "");
  }
}

// GIVEN a centre THEN states and their errors are those of a world that begins there.
TEST_P(NavStateManifoldTest, TheCentreIsTheOriginOfTheWorld) {
  RandomStates random(14);
  const Eigen::Vector3d p = random.Vector(300);
  const Eigen::Vector3d v = random.Vector(20);
  const NavStateManifold centred(GetParam(), p, v);
  const NavState near = random.Nav(5);
  NavState far = near;
  far.p_WB += p;
  far.v_WB += v;
  Vector9d delta;
  delta << random.Vector(0.1), random.Vector(1), random.Vector(1);
  AmbientVector moved;
  ASSERT_TRUE(centred.Plus(Block(far).data(), delta.data(), moved.data()));
  NavState expected = Retract(GetParam(), near, delta);
  expected.p_WB += p;
  expected.v_WB += v;
  EXPECT_LT((UnpackNavState(moved.data()).R_WB - expected.R_WB).norm(), 1e-12);
  EXPECT_LT((UnpackNavState(moved.data()).p_WB - expected.p_WB).norm(), 1e-10);
  EXPECT_LT((UnpackNavState(moved.data()).v_WB - expected.v_WB).norm(), 1e-10);
}

TEST_P(NavStateManifoldTest, LocalJacobianIsTheDerivativeOfLocalAwayFromTheOrigin) {
  RandomStates random(13);
  for (int trial = 0; trial < 20; ++trial) {
    const NavState origin = random.Nav(5);
    Vector9d shift;
    shift << random.Vector(0.5), random.Vector(1), random.Vector(1);
    const NavState state = Retract(GetParam(), origin, shift);
    const auto local = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
      return Local(GetParam(), origin, Retract(GetParam(), state, Vector9d(xi)));
    };
    const Eigen::MatrixXd numeric = test::NumericJacobian(local, kNavTangentSize);
    EXPECT_EQ(CompareJacobians(LocalJacobian(GetParam(), origin, state), numeric, 1e-8), "");
  }
  const NavState state = random.Nav(5);
  EXPECT_LT((LocalJacobian(GetParam(), state, state) - Matrix9d::Identity()).norm(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Conventions, NavStateManifoldTest, testing::ValuesIn(kAllConventions),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade
