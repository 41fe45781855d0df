#include "smoother/factors/spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::VectorXd;

const Eigen::Vector3d kCamera_B(0.1, -0.2, 0.3);  // NOLINT(cert-err58-cpp): cannot throw

std::vector<NavState> RandomPath(unsigned seed, int count) {
  test::RandomStates random(seed);
  std::vector<NavState> states;
  states.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    states.push_back(random.Nav(2));
  }
  return states;
}

/// (phi, dp) of the body at each state: R Exp(phi), p + dp.
std::vector<NavState> Moved(std::vector<NavState> states, const VectorXd& delta) {
  for (size_t i = 0; i < states.size(); ++i) {
    const auto at = 6 * static_cast<Eigen::Index>(i);
    states[i].R_WB = states[i].R_WB * so3::Exp(Eigen::Vector3d(delta.segment<3>(at)));
    states[i].p_WB += delta.segment<3>(at + 3);
  }
  return states;
}

TEST(Spread, IsTheRootMeanSquareDistanceFromTheMean) {
  std::vector<NavState> states(4);
  const double x_m[] = {0, 0, 2, 2};
  for (size_t i = 0; i < states.size(); ++i) {
    states[i].p_WB = {x_m[i], 5, -7};
  }
  EXPECT_DOUBLE_EQ(SpreadOf(states, kCamera_B).metres, 1);
}

TEST(Spread, SlopeIsThatOfItsLogarithm) {
  const std::vector<NavState> states = RandomPath(3, 5);
  const auto logarithm = [&](const VectorXd& delta) -> VectorXd {
    return VectorXd::Constant(1, std::log(SpreadOf(Moved(states, delta), kCamera_B).metres));
  };
  const Eigen::MatrixXd numeric = test::NumericJacobian(logarithm, 30);
  const Eigen::MatrixXd slope = SpreadOf(states, kCamera_B).slope;
  EXPECT_LT((slope.reshaped() - numeric.transpose()).norm(), 1e-6 * numeric.norm());
}

TEST(Shape, JacobianIsThatOfThePositions) {
  const std::vector<NavState> states = RandomPath(4, 5);
  const auto positions = [&](const VectorXd& delta) -> VectorXd {
    return ShapeOf(Moved(states, delta), kCamera_B).positions.reshaped();
  };
  const Eigen::MatrixXd numeric = test::NumericJacobian(positions, 30);
  EXPECT_LT((ShapeOf(states, kCamera_B).jacobian - numeric).norm(), 1e-6 * numeric.norm());
}

// GIVEN a window WHEN the whole of it is turned and shifted THEN its shape stays as it is.
TEST(Shape, IsInvariantToRotationAndShiftOfTheWindow) {
  const std::vector<NavState> states = RandomPath(5, 5);
  std::vector<NavState> moved = states;
  const Eigen::Matrix3d turn = so3::Exp(Eigen::Vector3d(0.3, -0.5, 1.2));
  for (NavState& state : moved) {
    state.R_WB = turn * state.R_WB;
    state.p_WB = turn * state.p_WB + Eigen::Vector3d(10, -20, 30);
  }
  const Eigen::Matrix3Xd before = ShapeOf(states, kCamera_B).positions;
  EXPECT_LT((ShapeOf(moved, kCamera_B).positions - before).norm(), 1e-12 * before.norm());
}

}  // namespace
}  // namespace alidade
