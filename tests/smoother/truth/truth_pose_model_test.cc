#include "smoother/truth/truth_pose_model.h"

#include <gtest/gtest.h>

#include "core/error_convention.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

TruthConstants RandomConstants(test::RandomStates* states) {
  TruthConstants constants;
  constants.R_TW = so3::Between(Vector3d::UnitZ(), Vector3d::UnitZ() + states->Vector(0.2));
  constants.T_BM = states->RandomPose(0.3);
  constants.time_offset_s = states->Uniform(-0.1, 0.1);
  return constants;
}

Pose Recorded(const TruthConstants& constants, const NavState& state) {
  return Pose{constants.R_TW, Vector3d::Zero()} * state.T_WB() * constants.T_BM;
}

TEST(TruthPoseModelTest, ResidualIsZeroAtTheTruthAndEqualsTheErrorElsewhere) {
  test::RandomStates states(1);
  const TruthConstants constants = RandomConstants(&states);
  const NavState state = states.Nav(3);
  Pose recorded = Recorded(constants, state);
  Vector6d residual;
  TruthPoseModel{recorded}.Evaluate(state, Vector3d::Zero(), constants, &residual, nullptr, nullptr);
  EXPECT_LT(residual.norm(), 1e-12);
  recorded.translation.x() -= 0.1;
  recorded.rotation = recorded.rotation * so3::Exp(Vector3d(0, -0.2, 0));
  TruthPoseModel{recorded}.Evaluate(state, Vector3d::Zero(), constants, &residual, nullptr, nullptr);
  EXPECT_NEAR(residual[1], 0.2, 1e-12);
  EXPECT_NEAR(residual[3], 0.1, 1e-12);
}

TEST(TruthPoseModelTest, JacobiansAreNumeric) {
  test::RandomStates states(2);
  for (int i = 0; i < 20; ++i) {
    const TruthConstants constants = RandomConstants(&states);
    const NavState state = states.Nav(3);
    const Vector3d rate = states.Vector(2);
    Pose recorded = Recorded(constants, state);
    recorded.rotation = recorded.rotation * so3::Exp(states.Vector(0.3));
    recorded.translation += states.Vector(0.5);
    const TruthPoseModel model{recorded};
    Vector6d residual, same;
    Eigen::Matrix<double, 6, 9> of_state;
    Eigen::Matrix<double, 6, kTruthConstants> of_constants;
    model.Evaluate(state, rate, constants, &residual, &of_state, &of_constants);
    model.Evaluate(state, rate, constants, &same, nullptr, nullptr);
    EXPECT_EQ(residual, same);
    for (const ErrorConvention convention : test::kAllConventions) {
      const auto moved = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
        Vector6d r;
        model.Evaluate(Retract(convention, state, Vector9d(xi)), rate, constants, &r, nullptr, nullptr);
        return r;
      };
      EXPECT_EQ(test::CompareJacobians(of_state * ChartJacobian(convention, state),
                                       test::NumericJacobian(moved, 9), 1e-7),
                "");
    }
    // The time offset moves the state along its rate and velocity; a tilt is not brought back to the least
    // rotation here, for that turns the world about its vertical too.
    const auto moved = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
      TruthConstants other = constants;
      other.R_TW = constants.R_TW * so3::Exp(Vector3d(xi[kTiltColumn], xi[kTiltColumn + 1], 0));
      other.T_BM.rotation = constants.T_BM.rotation * so3::Exp(Vector3d(xi.segment<3>(kMarkerColumn)));
      other.T_BM.translation += xi.segment<3>(kLeverColumn);
      NavState later = state;
      later.R_WB = state.R_WB * so3::Exp(xi[kTimeColumn] * rate);
      later.p_WB += xi[kTimeColumn] * state.v_WB;
      Vector6d r;
      model.Evaluate(later, rate, other, &r, nullptr, nullptr);
      return r;
    };
    EXPECT_EQ(test::CompareJacobians(of_constants, test::NumericJacobian(moved, kTruthConstants), 1e-7), "");
  }
}

TEST(TruthPoseModelTest, ARetractedTiltTurnsNothingAboutTheVertical) {
  test::RandomStates states(3);
  const TruthConstants constants = RandomConstants(&states);
  TruthConstantsError error = TruthConstantsError::Zero();
  error.head<2>() << 0.01, -0.02;
  error[kTimeColumn] = 0.003;
  const TruthConstants moved = Retract(constants, error);
  EXPECT_LT(std::abs(so3::Log(moved.R_TW).z()), 1e-12);
  EXPECT_LT((moved.R_TW * Vector3d::UnitZ() -
             constants.R_TW * so3::Exp(Vector3d(0.01, -0.02, 0)) * Vector3d::UnitZ())
                .norm(),
            1e-12);
  EXPECT_EQ(moved.time_offset_s, constants.time_offset_s + 0.003);
}

}  // namespace
}  // namespace alidade
