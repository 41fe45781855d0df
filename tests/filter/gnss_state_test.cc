#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "filter/filter_state.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade::test {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

class GnssStateTest : public testing::TestWithParam<ErrorConvention> {};

/// A state with two clones, correlated by propagation.
FilterState MakeState(ErrorConvention convention, RandomStates* random) {
  FilterState state(convention, false, {random->Rotation(), random->Vector(0.2)}, {3, 1, true});
  NavEstimate initial;
  initial.nav = {random->Rotation(), random->Vector(5), random->Vector(2)};
  const Matrix15d root = 0.1 * Matrix15d::NullaryExpr([&] { return random->Uniform(-1, 1); });
  initial.covariance = root * root.transpose();
  EXPECT_TRUE(state.Reset(initial).ok());
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 20; ++k) {
    samples.push_back({k * 10'000'000LL, random->Vector(0.5), Vector3d(0, 0, 9.81) + random->Vector(1)});
  }
  state.AddClone(1);
  EXPECT_TRUE(state.Propagate(samples, ImuNoise(), GravityInWorld(9.81)).ok());
  state.AddClone(2);
  return state;
}

// GIVEN errors of pose and yaw, WHEN the state is turned into ENU, THEN the covariance is that of the turned
// errors, by differences through Retract and Local.
TEST_P(GnssStateTest, AlignCarriesTheCovariance) {
  RandomStates random(7);
  FilterState state = MakeState(GetParam(), &random);
  const NavState nav = state.nav();
  const Pose newest = state.clones()[1].T_WB;
  const Pose oldest = state.clones()[0].T_WB;
  const MatrixXd before = state.covariance().Covariance();
  const double yaw = 1.1;
  const Vector3d shift(4, -7, 2);
  Eigen::Matrix4d covariance = Eigen::Vector4d(0.01, 1, 2, 3).asDiagonal();
  covariance(0, 1) = covariance(1, 0) = 0.03;
  const auto turned = [&](const NavState& s, const Eigen::Vector4d& u) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(yaw + u[0], Vector3d::UnitZ()).toRotationMatrix();
    return NavState{R * s.R_WB, R * s.p_WB + shift + u.tail<3>(), R * s.v_WB};
  };
  const Eigen::Vector4d zero = Eigen::Vector4d::Zero();
  // Error order: core 15, newest clone, oldest clone; then the four of the alignment.
  const auto errors_after = [&](const Eigen::VectorXd& xi) -> Eigen::VectorXd {
    const Eigen::Vector4d u = xi.tail<4>();
    const auto pose = [&](const Pose& T, const Vector6d& e) {
      const Pose truth = Retract(GetParam(), T, e);
      const NavState moved = turned({truth.rotation, truth.translation, Vector3d::Zero()}, u);
      const NavState center = turned({T.rotation, T.translation, Vector3d::Zero()}, zero);
      return Local(GetParam(), center.T_WB(), moved.T_WB());
    };
    Eigen::VectorXd after(27);
    after.head<9>() =
        Local(GetParam(), turned(nav, zero), turned(Retract(GetParam(), nav, Vector9d(xi.head<9>())), u));
    after.segment<6>(9) = xi.segment<6>(9);
    after.segment<6>(15) = pose(newest, xi.segment<6>(15));
    after.segment<6>(21) = pose(oldest, xi.segment<6>(21));
    return after;
  };
  const MatrixXd jacobian = NumericJacobian(errors_after, 31);
  MatrixXd joint = MatrixXd::Zero(31, 31);
  joint.topLeftCorner<27, 27>() = before;
  joint.bottomRightCorner<4, 4>() = covariance;
  const MatrixXd expected = jacobian * joint * jacobian.transpose();

  const Matrix6d clock = 9 * Matrix6d::Identity();
  state.Align({yaw, shift}, covariance, clock);
  const MatrixXd after = state.covariance().Covariance();
  ASSERT_EQ(after.rows(), 33);
  EXPECT_TRUE(after.topLeftCorner(6, 6).isApprox(clock, 1e-12));
  EXPECT_LT(after.topRightCorner(6, 27).norm(), 1e-12);
  EXPECT_EQ(CompareJacobians(after.bottomRightCorner(27, 27), expected, 1e-7), "");
  EXPECT_TRUE(state.nav().p_WB.isApprox(turned(nav, zero).p_WB, 1e-12));
}

// GIVEN an alignment from position fixes, WHEN no clock is known, THEN the state is aligned the same and has
// no clock.
TEST_P(GnssStateTest, AlignsWithoutAClock) {
  RandomStates random(8);
  FilterState with = MakeState(GetParam(), &random);
  RandomStates again(8);
  FilterState without = MakeState(GetParam(), &again);
  const YawShift transform{2.0, {1, 2, 3}};
  const Eigen::Matrix4d covariance = Eigen::Vector4d(0.01, 1, 2, 3).asDiagonal();
  with.Align(transform, covariance, Matrix6d(Matrix6d::Identity()));
  without.Align(transform, covariance, std::nullopt);
  EXPECT_EQ(without.CoreOffset(), 0);
  EXPECT_EQ(without.nav().p_WB, with.nav().p_WB);
  ASSERT_EQ(without.covariance().dimension() + 6, with.covariance().dimension());
  EXPECT_TRUE(without.covariance().Covariance().isApprox(
      with.covariance().Covariance().bottomRightCorner(27, 27), 1e-12));
}

// GIVEN a clock before the core and a landmark before the clock, WHEN it is propagated, THEN the covariance
// is the dense one.
TEST_P(GnssStateTest, ClockPropagatesAsTheDenseCovariance) {
  RandomStates random(9);
  FilterState state = MakeState(GetParam(), &random);
  state.Align({}, Eigen::Matrix4d::Identity(), 4 * Matrix6d::Identity());
  SquareRootCovariance& covariance = state.covariance();
  // A landmark before it and an update correlate everything.
  covariance.AddLeading(0.5 * Eigen::Matrix3d::Identity(), MatrixXd::Random(3, covariance.dimension() - 6));
  MatrixXd rows = MatrixXd::Random(8, covariance.dimension());
  Eigen::VectorXd correction(covariance.dimension());
  Eigen::VectorXd innovation = Eigen::VectorXd::Ones(8);
  ASSERT_TRUE(covariance.Apply(covariance.Prepare(rows, innovation), correction, nullptr));
  const MatrixXd before = covariance.Covariance();
  Matrix6d phi = Matrix6d::Identity();
  phi(0, 1) = 0.3;
  phi(2, 2) = 0;
  Matrix6d q = Matrix6d::Zero();
  q(0, 0) = 0.4;
  q(0, 1) = q(1, 0) = 0.1;
  q(1, 1) = 0.3;
  q(2, 2) = 2;
  covariance.PropagateLeading(3, phi, q);
  MatrixXd dense_phi = MatrixXd::Identity(before.rows(), before.rows());
  dense_phi.block<6, 6>(3, 3) = phi;
  MatrixXd expected = dense_phi * before * dense_phi.transpose();
  expected.block<6, 6>(3, 3) += q;
  EXPECT_TRUE(covariance.Covariance().isApprox(expected, 1e-10));
  EXPECT_TRUE(MatrixXd(covariance.factor()).isUpperTriangular(1e-12));
}

INSTANTIATE_TEST_SUITE_P(Conventions, GnssStateTest,
                         testing::Values(ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant,
                                         ErrorConvention::kSo3xRn),
                         [](const auto& test) { return std::string(ToString(test.param)); });

}  // namespace
}  // namespace alidade::test
