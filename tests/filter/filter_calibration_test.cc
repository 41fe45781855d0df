#include <gtest/gtest.h>

#include "filter/filter_state.h"
#include "filter/square_root_covariance.h"
#include "filter/track_store.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

NavEstimate SomeState(test::RandomStates* random) {
  NavEstimate estimate;
  estimate.nav = random->Nav(3);
  estimate.bias = random->Bias();
  const Matrix15d root = 0.1 * Matrix15d::NullaryExpr([&] { return random->Uniform(-1, 1); });
  estimate.covariance = root * root.transpose() + 1e-4 * Matrix15d::Identity();
  return estimate;
}

CalibrationEstimate ExtrinsicsAndTime(const Pose& T_BC) {
  CalibrationConfig config;
  config.extrinsics = config.time_offset = true;
  return InitialCalibration(config, {CameraModel(), T_BC, 0.01});
}

TEST(TrailingCovarianceTest, ConstantsComeInIndependentAndRowsAddUp) {
  test::RandomStates random(61);
  SquareRootCovariance covariance(15 + 12 + 3);
  ASSERT_TRUE(covariance.Reset(SomeState(&random).covariance).ok());
  const Eigen::Vector3d deviations(0.1, 0.2, 0.3);
  covariance.AddTrailing(deviations);
  const MatrixXd with_constants = covariance.Covariance();
  EXPECT_LT((with_constants.bottomRightCorner<3, 3>() - MatrixXd(deviations.cwiseAbs2().asDiagonal())).norm(),
            1e-15);
  EXPECT_EQ((with_constants.topRightCorner<15, 3>().norm()), 0);
  covariance.CloneCore(0, 6);
  const MatrixXd before = covariance.Covariance();
  const Eigen::Matrix<double, 6, 2> gain =
      Eigen::Matrix<double, 6, 2>::NullaryExpr([&] { return random.Uniform(-1, 1); });
  covariance.AddToRows(15, gain, 22);
  MatrixXd map = MatrixXd::Identity(24, 24);
  map.block<6, 2>(15, 22) = gain;
  EXPECT_LT((covariance.Covariance() - map * before * map.transpose()).norm(), 1e-13);
  EXPECT_TRUE(covariance.factor().isUpperTriangular(0));
}

// GIVEN an uncertain time offset, WHEN the pose is cloned, THEN the clone's error is that of where the body
// is once the camera has seen, in every convention.
TEST(FilterCalibrationTest, CloneMovesWithTheTimeOffset) {
  for (const ErrorConvention convention :
       {ErrorConvention::kRightInvariant, ErrorConvention::kLeftInvariant, ErrorConvention::kSo3xRn}) {
    test::RandomStates random(62);
    FilterState state(convention, false, ExtrinsicsAndTime(random.RandomPose(0.2)), {3, 0, false});
    const NavEstimate initial = SomeState(&random);
    ASSERT_TRUE(state.Reset(initial).ok());
    const Eigen::Vector3d gyro = random.Vector(1);
    state.AddClone(1, MeasuredTurn{gyro});
    const MatrixXd p = state.covariance().Covariance();
    const double variance = std::pow(CalibrationConfig().time_offset_std_s, 2);
    // Numerically: the error of a pose that is dt further on.
    const double dt = 1e-5;
    const Eigen::Vector3d rate = gyro - initial.bias.gyro;
    const Pose later{initial.nav.R_WB * so3::Exp(rate * dt), initial.nav.p_WB + initial.nav.v_WB * dt};
    const Vector6d column = Local(convention, initial.nav.T_WB(), later) / dt;
    const int clone = state.CloneOffset(0);
    const int offset = state.CalibrationOffset() + 6;
    EXPECT_LT((p.block<6, 1>(clone, offset) - variance * column).norm(), 1e-4 * variance * column.norm());
    const Matrix6d own = p.block<6, 6>(0, 0);
    const Matrix6d expected = own + variance * column * column.transpose();
    EXPECT_LT((p.block<6, 6>(clone, clone) - expected).norm(), 1e-6 * expected.norm());
  }
}

TEST(FilterCalibrationTest, CorrectionMovesTheCameraAndEveryClone) {
  test::RandomStates random(63);
  const Pose T_BC = random.RandomPose(0.2);
  FilterState state(ErrorConvention::kRightInvariant, false, ExtrinsicsAndTime(T_BC), {3, 0, false});
  ASSERT_TRUE(state.Reset(SomeState(&random)).ok());
  state.AddClone(1);
  state.AddClone(2);
  VectorXd correction = VectorXd::Zero(state.covariance().dimension());
  ASSERT_EQ(correction.size(), 15 + 12 + 7);
  correction.segment<7>(state.CalibrationOffset()) << 0.01, -0.02, 0.03, 0.1, 0.2, 0.3, 0.004;
  state.Correct(correction);
  EXPECT_NEAR(state.calibration().time_offset_s, 0.014, 1e-15);
  EXPECT_LT((state.calibration().T_BC.translation - T_BC.translation - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(),
            1e-14);
  for (const Clone& clone : state.clones()) {
    const Pose expected = clone.T_WB * state.calibration().T_BC;
    EXPECT_LT((clone.T_WC.translation - expected.translation).norm(), 1e-14);
    EXPECT_LT((clone.T_WC.rotation - expected.rotation).norm(), 1e-14);
  }
  ASSERT_TRUE(state.Reset(SomeState(&random)).ok());
  EXPECT_EQ(state.calibration().T_BC.translation, T_BC.translation);
}

TEST(FilterCalibrationTest, ViewsKeepTheirPixelsWhenTheIntrinsicsMove) {
  const auto make = [](double focal) {
    return *CameraModel::Create(DistortionModel::kNone, {focal, focal, 320, 240}, {}, 640, 480);
  };
  TrackStore tracks(4, false);
  tracks.AddFrame(make(400), PixelNoise({.noise_ratios = true}), 1, {{7, {420, 240}}, {8, {420, 240}, 2}});
  EXPECT_NEAR(tracks.tracks()[0].views[0].observation.z.x(), 0.25, 1e-12);
  tracks.Renormalize(CalibrationLayout(), make(500), 1.0);
  EXPECT_NEAR(tracks.tracks()[0].views[0].observation.z.x(), 0.25, 1e-12) << "no intrinsics that could move";
  CalibrationConfig config;
  config.intrinsics = true;
  tracks.Renormalize(CalibrationLayout(config, make(500)), make(500), 1.0);
  EXPECT_NEAR(tracks.tracks()[0].views[0].observation.z.x(), 0.2, 1e-12);
  EXPECT_NEAR(tracks.tracks()[0].views[0].observation.sqrt_information(0, 0), 500, 1e-9);
  EXPECT_NEAR(tracks.tracks()[1].views[0].observation.sqrt_information(0, 0), 250, 1e-9);
}

}  // namespace
}  // namespace alidade
