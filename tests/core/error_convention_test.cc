#include "core/error_convention.h"

#include <gtest/gtest.h>

#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using test::RandomStates;

class EveryConvention : public ::testing::TestWithParam<ErrorConvention> {};
INSTANTIATE_TEST_SUITE_P(Conventions, EveryConvention, ::testing::ValuesIn(test::kAllConventions),
                         [](const auto& test_case) { return std::string(ToString(test_case.param)); });

TEST_P(EveryConvention, LocalInvertsRetract) {
  RandomStates random(1);
  for (int i = 0; i < 50; ++i) {
    const NavState estimate = random.Nav(10);
    Vector9d xi;
    xi << random.Vector(1.5), random.Vector(5), random.Vector(5);
    EXPECT_LT((Local(GetParam(), estimate, Retract(GetParam(), estimate, xi)) - xi).norm(), 1e-12);
    const Pose pose = random.RandomPose(10);
    EXPECT_LT(
        (Local(GetParam(), pose, Retract(GetParam(), pose, Vector6d(xi.head<6>()))) - xi.head<6>()).norm(),
        1e-12);
  }
}

TEST_P(EveryConvention, ZeroErrorIsTheEstimate) {
  const NavState estimate = RandomStates(2).Nav(10);
  const NavState same = Retract(GetParam(), estimate, Vector9d::Zero());
  EXPECT_EQ(same.p_WB, estimate.p_WB);
  EXPECT_LT((same.R_WB - estimate.R_WB).norm(), 1e-15);
}

TEST_P(EveryConvention, ChartJacobianDifferentiatesTheCanonicalChart) {
  RandomStates random(3);
  for (int i = 0; i < 20; ++i) {
    const NavState estimate = random.Nav(10);
    const auto chart = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
      return Local(ErrorConvention::kSo3xRn, estimate, Retract(GetParam(), estimate, Vector9d(xi)));
    };
    EXPECT_EQ(
        test::CompareJacobians(ChartJacobian(GetParam(), estimate), test::NumericJacobian(chart, 9), 1e-9),
        "");
  }
}

TEST_P(EveryConvention, InverseChartJacobianInverts) {
  RandomStates random(4);
  const NavState nav = random.Nav(10);
  EXPECT_LT(
      (ImuChartJacobian(GetParam(), nav) * InverseImuChartJacobian(GetParam(), nav) - Matrix15d::Identity())
          .norm(),
      1e-12);
  const Pose pose = random.RandomPose(10);
  EXPECT_LT((ChartJacobian(GetParam(), pose) * InverseChartJacobian(GetParam(), pose) - Matrix6d::Identity())
                .norm(),
            1e-12);
}

TEST_P(EveryConvention, NamesAreReadBack) {
  EXPECT_EQ(ParseErrorConvention(ToString(GetParam())), GetParam());
}

TEST(ErrorConventionTest, UnknownNameIsRefused) {
  EXPECT_FALSE(ParseErrorConvention("right").has_value());
}

// The paper's definition, eq. 3-1, written out.
TEST(ErrorConventionTest, RightInvariantIsThePapers) {
  RandomStates random(5);
  const NavState estimate = random.Nav(3);
  Vector9d xi;
  xi << random.Vector(0.5), random.Vector(1), random.Vector(1);
  const NavState truth = Retract(ErrorConvention::kRightInvariant, estimate, xi);
  const Eigen::Matrix3d turn = so3::Exp(xi.head<3>());
  EXPECT_LT((truth.R_WB - turn * estimate.R_WB).norm(), 1e-14);
  EXPECT_LT((truth.v_WB - (turn * estimate.v_WB + xi.tail<3>())).norm(), 1e-14);
}

}  // namespace
}  // namespace alidade
