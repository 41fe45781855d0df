#include "filter/landmark_view.h"

#include <gtest/gtest.h>

#include <type_traits>

#include "core/landmark_reduction.h"
#include "filter/feature_update.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::RandomStates;

const Pose kExtrinsics{so3::Exp({0.1, -0.2, 0.05}), {0.1, 0.02, -0.05}};
const Vector3d kPoint(1.5, -0.8, 9);

FilterState OneClone(ErrorConvention convention, RandomStates* random, const Pose& T_BC = kExtrinsics) {
  FilterState state(convention, false, T_BC, {2, 1});
  NavEstimate initial;
  initial.nav = {so3::Exp(random->Vector(0.2)), random->Vector(1), random->Vector(1)};
  initial.covariance.diagonal().setConstant(1e-4);
  EXPECT_TRUE(state.Reset(initial).ok());
  state.AddClone(1);
  return state;
}

NormalizedObservation SomeObservation(RandomStates* random) {
  NormalizedObservation observation;
  observation.z = random->Vector(0.2).head<2>();
  observation.sqrt_information << 400, 10, -20, 500;
  return observation;
}

/// The true landmark of an error f~, where the anchor's attitude is off by theta.
Vector3d Truth(const LandmarkError& error, const Vector3d& theta, const Vector3d& f) {
  return error.anchored() ? Vector3d(so3::Exp(theta) * kPoint + f) : Vector3d(kPoint + f);
}

/// Of kPoint, wherever it lies, with an error of about a degree.
NormalizedObservation TangentObservation(const Pose& T_WC, RandomStates* random) {
  NormalizedObservation observation = SomeObservation(random);
  observation.z.setZero();
  const Vector3d direction = (T_WC.Inverse() * kPoint).normalized() + random->Vector(0.02);
  observation.plane = BearingPlane::TangentAt(direction);
  return observation;
}

// The rows over the error of the view's clone, of the anchor's attitude and of the landmark: ahead of the
// camera on the plane z = 1, and anywhere around it on tangent planes.
TEST(LandmarkViewTest, RowsAreNumericInEveryConvention) {
  RandomStates random(81);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 40; ++trial) {
      const bool around = trial >= 20;
      const Pose T_BC = around ? random.RandomPose(0.2) : kExtrinsics;
      const FilterState state = OneClone(convention, &random, T_BC);
      const Clone& clone = state.clones().front();
      const NormalizedObservation observation =
          around ? TangentObservation(clone.T_WC, &random) : SomeObservation(&random);
      const LandmarkError error = state.landmark_error();
      LandmarkViewRows rows;
      ASSERT_TRUE(LinearizeView(state, clone, observation, kPoint, kPoint, &rows));
      MatrixXd analytic = MatrixXd::Zero(2, 12);
      analytic.leftCols<6>() = rows.clone;
      analytic.rightCols<3>() = rows.landmark;
      if (error.anchored()) {
        analytic.middleCols<3>(6) = LandmarkError::OverAnchor(rows.landmark, kPoint);
      }
      const auto residual = [&](const VectorXd& xi) -> VectorXd {
        const Pose T_WC = Retract(convention, clone.T_WB, Vector6d(xi.head<6>())) * T_BC;
        ObservationRows moved;
        EXPECT_TRUE(
            LinearizeObservation(T_WC, observation, Truth(error, xi.segment<3>(6), xi.tail<3>()), &moved));
        return moved.residual;
      };
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(residual, 12), 1e-7), "");
      EXPECT_LT((rows.residual - residual(VectorXd::Zero(12))).norm(), 1e-9);
      EXPECT_EQ(rows.calibration.cols(), 0);
    }
  }
}

// Through a rolling shutter: the camera has moved on by the row's time, and the rows over extrinsics and line
// delay are its derivatives.
TEST(LandmarkViewTest, RowsOfARollingShutterAreNumeric) {
  RandomStates random(83);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      CalibrationConfig config;
      config.extrinsics = config.line_delay = true;
      const CalibrationEstimate calibration =
          InitialCalibration(config, {CameraModel(), kExtrinsics, 0, trial == 0 ? 0 : 5e-5});
      FilterState state(convention, false, calibration, {2, 1, false});
      NavEstimate initial;
      initial.nav = {so3::Exp(random.Vector(0.2)), random.Vector(1), random.Vector(2)};
      initial.covariance.diagonal().setConstant(1e-4);
      ASSERT_TRUE(state.Reset(initial).ok());
      state.AddClone(1, {random.Vector(2), random.Vector(10)});
      const Clone& clone = state.clones().front();
      NormalizedObservation observation = SomeObservation(&random);
      observation.row_px = random.Uniform(-240, 240);
      LandmarkViewRows rows;
      ASSERT_TRUE(LinearizeView(state, clone, observation, kPoint, kPoint, &rows));
      MatrixXd analytic(2, 13);
      analytic << rows.clone, rows.calibration;
      const auto residual = [&](const VectorXd& xi) -> VectorXd {
        const Pose T_WB = Retract(convention, clone.T_WB, Vector6d(xi.head<6>()));
        const Pose T_BC = Retract(ErrorConvention::kSo3xRn, kExtrinsics, Vector6d(xi.segment<6>(6)));
        // A millisecond a row is the unit of the last coordinate.
        const double later_s = (*calibration.mean.line_delay_s + 1e-3 * xi[12]) * observation.row_px;
        const Vector3d turn = later_s * clone.motion.omega_B + later_s * later_s / 2 * clone.motion.alpha_B;
        const Pose body_after{T_WB.rotation * so3::Exp(turn),
                              T_WB.translation + later_s * (T_WB.rotation * clone.motion.v_B)};
        ObservationRows moved;
        EXPECT_TRUE(LinearizeObservation(body_after * T_BC, observation, kPoint, &moved));
        return moved.residual;
      };
      analytic.col(12) *= 1e-3;
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(residual, 13), 1e-6), "");
      EXPECT_LT((rows.residual - residual(VectorXd::Zero(13))).norm(), 1e-9);
      EXPECT_LT((state.CameraPoseAt(clone, observation).translation -
                 state.CameraAt(clone, observation).T_WC.translation)
                    .norm(),
                1e-12);
    }
  }
}

TEST(LandmarkViewTest, ALandmarkBehindTheCameraIsRefused) {
  RandomStates random(82);
  const FilterState state = OneClone(ErrorConvention::kRightInvariant, &random);
  LandmarkViewRows rows;
  EXPECT_FALSE(
      LinearizeView(state, state.clones().front(), SomeObservation(&random), -kPoint, -kPoint, &rows));
}

TEST(LandmarkErrorTest, TheLeverMovesTheAnchor) {
  const LandmarkError error(ErrorConvention::kRightInvariant);
  ASSERT_TRUE(error.anchored());
  // The same true landmark by the attitude errors of two anchors, over (theta_a, theta_b, f~).
  const auto error_from_b = [&](const VectorXd& xi) -> VectorXd {
    return Truth(error, xi.head<3>(), xi.tail<3>()) -
           LandmarkError::Turned(xi.segment<3>(3), kPoint, Eigen::Vector3d::Zero());
  };
  MatrixXd analytic(3, 9);
  analytic << -LandmarkError::Lever(kPoint), LandmarkError::Lever(kPoint), Eigen::Matrix3d::Identity();
  EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(error_from_b, 9), 1e-9), "");
  EXPECT_FALSE(LandmarkError(ErrorConvention::kLeftInvariant).anchored());
  EXPECT_FALSE(LandmarkError(ErrorConvention::kSo3xRn).anchored());
}

// Rows H cannot be taken for prepared rows H S: only the covariance makes these.
static_assert(!std::is_constructible_v<PreparedRows, Eigen::Ref<MatrixXd>, Eigen::Ref<VectorXd>, int>);
static_assert(!std::is_default_constructible_v<PreparedRows>);

TEST(PreparedRowsDeathTest, RowsOnceHandedOverAreRefused) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // OpenBLAS has threads
  RandomStates random(83);
  FilterState state = OneClone(ErrorConvention::kRightInvariant, &random);
  FeatureUpdate update(FilterConfig(), VisionConfig(), 2);
  update.Begin(state);
  update.AddBlock(2);
  update.innovation().setZero();
  EXPECT_EQ(update.jacobian().rows(), 2);
  const PreparedRows prepared = update.Prepare(-1, &state.covariance());
  EXPECT_EQ(state.covariance().NormalizedInnovationSquared(prepared, 0, 2), 0);
  EXPECT_DEATH((void)update.jacobian(), "prepared");
  EXPECT_DEATH((void)update.Prepare(-1, &state.covariance()), "prepared");
  update.Begin(state);
  EXPECT_EQ(update.jacobian().rows(), 0);
}

}  // namespace
}  // namespace alidade
