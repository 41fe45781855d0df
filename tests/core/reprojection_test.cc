#include "core/reprojection.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error_convention.h"
#include "core/inverse_depth.h"
#include "core/landmark_reduction.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::RandomStates;

constexpr double kTolerance = 1e-8;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Pose Moved(ErrorConvention convention, const Pose& pose, const VectorXd& xi) {
  return Retract(convention, pose, Vector6d(xi));
}

TEST(ProjectionTest, JacobianIsNumericAndTheScaleDoesNotMatter) {
  RandomStates random(61);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3d q = random.Vector(2) + Vector3d(0, 0, 3);
    Vector2d projected;
    PointRows<2> jacobian = PointRows<2>::Constant(kNan);
    ASSERT_TRUE(ProjectToPlane(q, kMinPointDepth, &projected, &jacobian));
    const auto project = [&](const VectorXd& d) -> VectorXd {
      Vector2d moved = Vector2d::Zero();
      EXPECT_TRUE(ProjectToPlane(q + Vector3d(d), kMinPointDepth, &moved));
      return moved;
    };
    EXPECT_EQ(test::CompareJacobians(jacobian, test::NumericJacobian(project, 3), kTolerance), "");
    EXPECT_EQ(project(VectorXd::Zero(3)), projected) << "the same with and without a Jacobian";
    Vector2d of_multiple;
    ASSERT_TRUE(ProjectToPlane(8 * q, kMinPointDepth, &of_multiple));
    EXPECT_EQ(of_multiple, projected);
  }
}

TEST(ProjectionTest, PointsOutsideTheDomainAreRefusedAndLeaveTheOutputs) {
  for (const double depth : {0.0, -0.0, -1.0, 1e-3, kNan}) {
    Vector2d projected(7, 8);
    PointRows<2> jacobian = PointRows<2>::Constant(9);
    EXPECT_FALSE(ProjectToPlane({0.1, 0.2, depth}, 1e-3, &projected, &jacobian)) << depth;
    EXPECT_EQ(projected, Vector2d(7, 8));
    EXPECT_EQ(jacobian, PointRows<2>::Constant(9));
  }
  Vector2d projected;
  EXPECT_TRUE(ProjectToPlane({0.1, 0.2, 1.01e-3}, 1e-3, &projected));
}

TEST(ReprojectionTest, PointOfTheWorldIsNumericInEveryConvention) {
  RandomStates random(62);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const Vector3d p_W = random.Vector(5);
      const Pose T_WC = random.CamerasLookingAt(p_W, 1, 6, 1.0).front();
      const PointInCamera seen(T_WC, p_W);
      Vector2d predicted;
      PointRows<2> over_q;
      ASSERT_TRUE(ProjectToPlane(seen.q, kMinPointDepth, &predicted, &over_q));
      PoseRows<2> over_camera;
      PointRows<2> over_point;
      seen.Chain(over_q, &over_camera, &over_point);
      MatrixXd analytic(2, 9);
      analytic << over_camera * ChartJacobian(convention, T_WC), over_point;
      const auto project = [&](const VectorXd& xi) -> VectorXd {
        Vector2d moved = Vector2d::Zero();
        const Pose camera = Moved(convention, T_WC, xi.head(6));
        EXPECT_TRUE(
            ProjectToPlane(PointInCamera(camera, p_W + Vector3d(xi.tail<3>())).q, kMinPointDepth, &moved));
        return moved;
      };
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(project, 9), kTolerance), "");
    }
  }
}

/// Where an anchored landmark is in a camera, over (anchor, camera, landmark).
VectorXd ScaledPoint(ErrorConvention convention, const Pose& T_WA, const Pose& T_WC, const Vector3d& landmark,
                     const VectorXd& xi) {
  const Pose anchor = Moved(convention, T_WA, xi.head(6));
  const Pose camera = Moved(convention, T_WC, xi.segment(6, 6));
  return AnchoredPointInCamera(anchor, camera, landmark + Vector3d(xi.tail<3>())).q;
}

TEST(ReprojectionTest, AnchoredLandmarkIsNumericInEveryConvention) {
  RandomStates random(63);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const Pose T_WA = random.RandomPose(3);
      const Pose T_WC = random.RandomPose(3);
      // In front of the anchor, at infinity, or beyond it.
      const Vector3d landmark(random.Uniform(-1, 1), random.Uniform(-1, 1), 0.3 * (trial % 3 - 1));
      const AnchoredPointInCamera seen(T_WA, T_WC, landmark);
      PoseRows<3> over_anchor;
      PoseRows<3> over_camera;
      PointRows<3> over_landmark;
      const PointRows<3> over_q = PointRows<3>::Identity();
      seen.Chain(over_q, &over_anchor, &over_camera, &over_landmark);
      MatrixXd analytic(3, 15);
      analytic << over_anchor * ChartJacobian(convention, T_WA),
          over_camera * ChartJacobian(convention, T_WC), over_landmark;
      const auto move = [&](const VectorXd& xi) { return ScaledPoint(convention, T_WA, T_WC, landmark, xi); };
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(move, 15), kTolerance), "");
      EXPECT_LT((move(VectorXd::Zero(15)) - seen.q).norm(), 1e-15);
    }
  }
}

TEST(ReprojectionTest, SeenFromItsAnchorALandmarkDoesNotDependOnTheCamera) {
  RandomStates random(64);
  const Pose T_WC = random.RandomPose(3);
  const Vector3d landmark(0.3, -0.2, 0.25);
  const AnchoredPointInCamera seen(T_WC, T_WC, landmark);
  EXPECT_LT((seen.q - Vector3d(0.3, -0.2, 1)).norm(), 1e-15);
  PoseRows<3> over_anchor;
  PoseRows<3> over_camera;
  const PointRows<3> over_q = PointRows<3>::Identity();
  seen.Chain(over_q, &over_anchor, &over_camera, nullptr);
  EXPECT_LT((over_anchor + over_camera).norm(), 1e-15);
}

TEST(ReprojectionTest, APointOfTheWorldAndItsAnchoredFormHaveTheSameRows) {
  RandomStates random(65);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3d p_W = random.Vector(5);
    const std::vector<Pose> views = random.CamerasLookingAt(p_W, 2, 6, 1.0);
    const Vector3d p_A = PointInCamera(views[0], p_W).q;
    const Vector3d landmark(p_A.x() / p_A.z(), p_A.y() / p_A.z(), 1 / p_A.z());
    NormalizedObservation observation;
    observation.z = random.Vector(0.1).head<2>();
    ObservationRows world;
    ASSERT_TRUE(LinearizeObservation(views[1], observation, p_W, &world));
    Vector2d residual;
    InverseDepthModel::PoseJacobian over_view;
    ASSERT_TRUE((InverseDepthModel{observation.z}.Evaluate(views[0], views[1], landmark, &residual, nullptr,
                                                           &over_view, nullptr)));
    EXPECT_LT((residual - world.residual).norm(), 1e-14);
    EXPECT_LT((over_view - world.pose_jacobian).norm(), 1e-13);
  }
}

TEST(ReprojectionTest, WhitenedRowsAreTheRowsTimesTheWhitening) {
  RandomStates random(66);
  const Vector3d p_W = random.Vector(5);
  const Pose T_WC = random.CamerasLookingAt(p_W, 1, 6, 1.0).front();
  NormalizedObservation observation;
  ObservationRows plain;
  ASSERT_TRUE(LinearizeObservation(T_WC, observation, p_W, &plain));
  observation.sqrt_information << 300, 20, -40, 500;
  ObservationRows whitened;
  ASSERT_TRUE(LinearizeObservation(T_WC, observation, p_W, &whitened));
  EXPECT_LT((whitened.residual - observation.sqrt_information * plain.residual).norm(), 1e-12);
  EXPECT_LT((whitened.pose_jacobian - observation.sqrt_information * plain.pose_jacobian).norm(), 1e-11);
  EXPECT_LT((whitened.point_jacobian - observation.sqrt_information * plain.point_jacobian).norm(), 1e-12);
  EXPECT_FALSE(LinearizeObservation(T_WC, observation, 2 * T_WC.translation - p_W, &whitened))
      << "behind the camera";
}

}  // namespace
}  // namespace alidade
