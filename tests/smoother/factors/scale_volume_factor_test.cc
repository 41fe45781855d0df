#include "smoother/factors/scale_volume_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "smoother/factors/spread.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kFrames = 4;
constexpr double kFreedom = 2;

class ScaleVolumeFactorTest : public testing::Test {
 protected:
  ScaleVolumeFactorTest() {
    test::RandomStates random(11);
    for (int i = 0; i < kFrames; ++i) {
      states_.push_back(random.Nav(2));
    }
  }

  /// The residual at R Exp(phi), p + dp, v + dv of each state, with its tangent Jacobians where asked for.
  double Residual(const VectorXd& delta, std::vector<Eigen::RowVectorXd>* jacobians) const {
    const ScaleVolumeFactor factor(kFrames, camera_B_, SpreadOf(states_, camera_B_).metres, kFreedom);
    std::vector<std::vector<double>> blocks;
    std::vector<const double*> parameters;
    for (size_t i = 0; i < states_.size(); ++i) {
      NavState state = states_[i];
      const auto of = delta.segment<9>(9 * static_cast<Index>(i));
      state.R_WB = state.R_WB * so3::Exp(Eigen::Vector3d(of.head<3>()));
      state.p_WB += of.segment<3>(3);
      state.v_WB += of.tail<3>();
      blocks.emplace_back(kNavAmbientSize);
      PackNavState(state, blocks.back().data());
    }
    for (const std::vector<double>& block : blocks) {
      parameters.push_back(block.data());
    }
    std::vector<double*> rows;
    if (jacobians != nullptr) {
      jacobians->assign(kFrames, Eigen::RowVectorXd::Zero(9));
      for (Eigen::RowVectorXd& row : *jacobians) {
        rows.push_back(row.data());
      }
    }
    double residual = 0;
    EXPECT_TRUE(factor.Evaluate(parameters.data(), &residual, jacobians != nullptr ? rows.data() : nullptr));
    return residual;
  }

  const Eigen::Vector3d camera_B_{0.1, -0.2, 0.3};
  std::vector<NavState> states_;
};

TEST_F(ScaleVolumeFactorTest, JacobianIsThatOfTheResidual) {
  std::vector<Eigen::RowVectorXd> rows;
  Residual(VectorXd::Zero(9 * kFrames), &rows);
  const auto residual = [&](const VectorXd& delta) -> VectorXd {
    return VectorXd::Constant(1, Residual(delta, nullptr));
  };
  const Eigen::MatrixXd numeric = test::NumericJacobian(residual, 9 * kFrames);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_LT((rows[static_cast<size_t>(i)] - numeric.middleCols(9 * i, 9)).norm(), 1e-6 * numeric.norm());
  }
}

// GIVEN a window WHEN all of its distances grow by a share THEN its cost falls by the degrees of freedom
// times that share.
TEST_F(ScaleVolumeFactorTest, SlopeAlongTheScaleIsTheFreedom) {
  constexpr double kShare = 1e-5;
  VectorXd delta = VectorXd::Zero(9 * kFrames);
  for (int i = 0; i < kFrames; ++i) {
    const NavState& state = states_[static_cast<size_t>(i)];
    delta.segment<3>(9 * i + 3) = kShare * (state.T_WB() * camera_B_ - states_.front().T_WB() * camera_B_);
  }
  const auto cost = [&](double sign) { return 0.5 * std::pow(Residual(sign * delta, nullptr), 2); };
  EXPECT_NEAR((cost(1) - cost(-1)) / (2 * kShare), -kFreedom, 1e-5);
}

TEST_F(ScaleVolumeFactorTest, IsUndefinedWithoutMotion) {
  states_.assign(kFrames, states_.front());
  const ScaleVolumeFactor factor(kFrames, camera_B_, 1, kFreedom);
  std::vector<double> block(kNavAmbientSize);
  PackNavState(states_.front(), block.data());
  const std::vector<const double*> parameters(kFrames, block.data());
  double residual = 0;
  EXPECT_FALSE(factor.Evaluate(parameters.data(), &residual, nullptr));
}

}  // namespace
}  // namespace alidade
