#include "core/bearing_plane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/inverse_depth.h"
#include "core/landmark_reduction.h"
#include "core/landmark_solver.h"
#include "core/pose_only.h"
#include "core/reprojection.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/random_states.h"

// Tangent planes of the unit sphere, and what composes the reprojection on them: landmarks anywhere around
// the cameras.

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::RandomStates;

constexpr double kTolerance = 1e-8;

Vector3d Near(const Vector3d& direction, double angle, RandomStates* random) {
  return (direction.normalized() + random->Vector(angle)).normalized();
}

TEST(BearingPlaneTest, AxesAreARotationAndTheNormalIsTheDirection) {
  RandomStates random(91);
  for (int trial = 0; trial < 40; ++trial) {
    Vector3d direction = random.Vector(3);
    direction = trial == 0 ? Vector3d(0, 0, 1) : trial == 1 ? Vector3d(0, 0, -1) : direction;
    direction = trial == 2 ? Vector3d(1e-9, 0, -2) : direction;
    const BearingPlane plane = BearingPlane::TangentAt(direction);
    EXPECT_TRUE(plane.is_tangent());
    EXPECT_LT((plane.axes().transpose() * plane.axes() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_NEAR(plane.axes().determinant(), 1, 1e-14);
    EXPECT_LT((plane.axes().col(2) - direction.normalized()).norm(), 1e-15);
    EXPECT_LT((plane.Direction({0, 0}) - direction.normalized()).norm(), 1e-15);
    const Vector2d point = random.Vector(1).head<2>();
    EXPECT_LT((plane.InAxes(plane.Direction(point)) - point.homogeneous()).norm(), 1e-14);
  }
}

TEST(BearingPlaneTest, TheNormalizedPlaneChangesNothing) {
  const BearingPlane plane;
  EXPECT_FALSE(plane.is_tangent());
  const Vector3d q(0.3, -0.2, 1.7);
  EXPECT_EQ(plane.InAxes(q), q);
  Vector2d plain, on_plane;
  PointRows<2> plain_rows, rows_on_plane;
  ASSERT_TRUE(ProjectToPlane(q, 0, &plain, &plain_rows));
  ASSERT_TRUE(ProjectToPlane(plane, q, 0, &on_plane, &rows_on_plane));
  EXPECT_EQ(plain, on_plane);
  EXPECT_EQ(plain_rows, rows_on_plane);
}

// B^T (q / |q| - u) by its own construction.
TEST(BearingPlaneTest, AResidualIsTheDifferenceOfUnitDirectionsInTheTangentPlane) {
  RandomStates random(92);
  for (int trial = 0; trial < 40; ++trial) {
    const Vector3d u = random.Vector(1).normalized();
    const Vector3d q = 5 * Near(u, 0.01, &random);
    const BearingPlane plane = BearingPlane::TangentAt(u);
    Vector2d point;
    ASSERT_TRUE(ProjectToPlane(plane, q, 0, &point));
    const Vector2d difference = plane.axes().leftCols<2>().transpose() * (q.normalized() - u);
    const double angle = std::acos(std::min(1.0, u.dot(q.normalized())));
    EXPECT_LT((point - difference).norm(), angle * angle * angle);
    EXPECT_NEAR(point.norm(), std::tan(angle), 1e-8);
  }
}

TEST(BearingPlaneTest, ProjectionJacobianIsNumericEverywhere) {
  RandomStates random(93);
  for (int trial = 0; trial < 40; ++trial) {
    const Vector3d q = random.Vector(3);
    const BearingPlane plane = BearingPlane::TangentAt(Near(q, 0.3, &random));
    Vector2d projected;
    PointRows<2> jacobian;
    ASSERT_TRUE(ProjectToPlane(plane, q, kMinPointDepth, &projected, &jacobian));
    const auto project = [&](const VectorXd& d) -> VectorXd {
      Vector2d moved = Vector2d::Zero();
      EXPECT_TRUE(ProjectToPlane(plane, q + Vector3d(d), kMinPointDepth, &moved));
      return moved;
    };
    EXPECT_EQ(test::CompareJacobians(jacobian, test::NumericJacobian(project, 3, 1e-5), kTolerance), "");
    EXPECT_EQ(project(VectorXd::Zero(3)), projected) << "the same with and without a Jacobian";
    EXPECT_FALSE(ProjectToPlane(plane, -q, kMinPointDepth, &projected, &jacobian));
  }
}

/// A point anywhere around two cameras, and their observations of it on tangent planes.
struct Surround {
  explicit Surround(RandomStates* random, int views, double noise = 0.05) : p_W(random->Vector(1)) {
    const Vector3d place = p_W + 5 * random->Vector(1).normalized();
    for (int i = 0; i < views; ++i) {
      T_WC.push_back({random->Rotation(), place + random->Vector(0.8)});
      const Vector3d q = PointInCamera(T_WC.back(), p_W).q;
      NormalizedObservation observation;
      observation.plane = BearingPlane::TangentAt(Near(q, noise, random));
      observation.sqrt_information << 300, 20, -40, 500;
      observations.push_back(observation);
    }
    const Vector3d in_axes = observations.front().plane.InAxes(PointInCamera(T_WC.front(), p_W).q);
    landmark << in_axes.hnormalized(), 1 / in_axes.z();
  }
  Vector3d p_W;
  std::vector<Pose> T_WC;
  std::vector<NormalizedObservation> observations;
  Vector3d landmark;  ///< in the first camera, on its plane
};

TEST(BearingPlaneTest, RowsOfAPointAreNumericInEveryConvention) {
  RandomStates random(94);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const Surround scene(&random, 1);
      const Pose& T_WC = scene.T_WC.front();
      ObservationRows rows;
      ASSERT_TRUE(LinearizeObservation(T_WC, scene.observations.front(), scene.p_W, &rows));
      MatrixXd analytic(2, 9);
      analytic << rows.pose_jacobian * ChartJacobian(convention, T_WC), rows.point_jacobian;
      const auto residual = [&](const VectorXd& xi) -> VectorXd {
        ObservationRows moved;
        EXPECT_TRUE(LinearizeObservation(Retract(convention, T_WC, Vector6d(xi.head<6>())),
                                         scene.observations.front(), scene.p_W + Vector3d(xi.tail<3>()),
                                         &moved));
        return moved.residual;
      };
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(residual, 9, 1e-5), kTolerance), "");
    }
  }
}

TEST(BearingPlaneTest, RowsOfAnAnchoredLandmarkAreNumericInEveryConvention) {
  RandomStates random(95);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const Surround scene(&random, 2);
      const InverseDepthModel model{scene.observations[1].z, scene.observations[1].plane,
                                    scene.observations[0].plane};
      Vector2d residual;
      InverseDepthModel::PoseJacobian over_anchor, over_view;
      InverseDepthModel::LandmarkJacobian over_landmark;
      ASSERT_TRUE(model.Evaluate(scene.T_WC[0], scene.T_WC[1], scene.landmark, &residual, &over_anchor,
                                 &over_view, &over_landmark));
      MatrixXd analytic(2, 15);
      analytic << over_anchor * ChartJacobian(convention, scene.T_WC[0]),
          over_view * ChartJacobian(convention, scene.T_WC[1]), over_landmark;
      const auto moved_residual = [&](const VectorXd& xi) -> VectorXd {
        Vector2d moved;
        EXPECT_TRUE(model.Evaluate(Retract(convention, scene.T_WC[0], Vector6d(xi.head<6>())),
                                   Retract(convention, scene.T_WC[1], Vector6d(xi.segment<6>(6))),
                                   scene.landmark + Vector3d(xi.tail<3>()), &moved, nullptr, nullptr,
                                   nullptr));
        return moved;
      };
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(moved_residual, 15, 1e-5), kTolerance),
                "");
      // Anchored or a point of the world: the same residual.
      ObservationRows world;
      NormalizedObservation plain = scene.observations[1];
      plain.sqrt_information.setIdentity();
      ASSERT_TRUE(LinearizeObservation(scene.T_WC[1], plain, scene.p_W, &world));
      EXPECT_LT((world.residual - residual).norm(), 1e-12);
    }
  }
}

TEST(BearingPlaneTest, PoseOnlyDepthAroundTheCamerasIsExactAndItsJacobiansNumeric) {
  RandomStates random(96);
  for (const DepthViews views : {DepthViews::kMulti, DepthViews::kTwo}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Surround exact(&random, 4, 0);
      PoseOnlyDepth depth;
      ASSERT_TRUE(ComputePoseOnlyDepth(exact.T_WC, exact.observations, 0, views, &depth));
      EXPECT_LT((depth.p_W - exact.p_W).norm(), 1e-9);
      EXPECT_NEAR(depth.depth, (exact.p_W - exact.T_WC.front().translation).norm(), 1e-9) << "of a unit ray";

      const Surround scene(&random, 4, 0.02);
      PoseOnlyJacobians jacobians;
      ASSERT_TRUE(ComputePoseOnlyDepth(scene.T_WC, scene.observations, 0, views, &depth, &jacobians));
      const auto point = [&](const VectorXd& xi) -> VectorXd {
        Surround moved = scene;
        for (size_t i = 0; i < 4; ++i) {
          const auto at = static_cast<Eigen::Index>(i);
          moved.T_WC[i] = Retract(ErrorConvention::kSo3xRn, scene.T_WC[i], Vector6d(xi.segment<6>(6 * at)));
          moved.observations[i].z += xi.segment<2>(24 + 2 * at);
        }
        PoseOnlyDepth there;
        EXPECT_TRUE(ComputePoseOnlyDepth(moved.T_WC, moved.observations, 0, views, &there));
        return there.p_W;
      };
      MatrixXd analytic(3, 32);
      analytic << jacobians.poses, jacobians.observations;
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(point, 32, 1e-5), 1e-6), "");
    }
  }
}

TEST(BearingPlaneTest, LandmarksAroundTheCamerasAreSolvedFor) {
  RandomStates random(97);
  for (int trial = 0; trial < 20; ++trial) {
    Surround scene(&random, 5, 0);
    const Vector3d wanted = scene.landmark;
    Vector3d landmark = wanted + Vector3d(0.02, -0.01, 0.05);
    ASSERT_TRUE(SolveLandmark(scene.T_WC, scene.observations, {}, &landmark));
    EXPECT_LT((landmark - wanted).norm(), 1e-6);
    Vector3d p_W = scene.p_W + random.Vector(0.2);
    ASSERT_TRUE(RefineLandmark(scene.T_WC, scene.observations, 20, &p_W));
    EXPECT_LT((p_W - scene.p_W).norm(), 1e-5);
  }
}

// The information of an eliminated landmark on the poses does not depend on the plane that carries the
// observations: in front of the cameras the tangent planes give the rows of z = 1, to first order in the
// noise.
TEST(BearingPlaneTest, BothPlanesGiveTheSameInformationOnThePosesInFrontOfTheCameras) {
  RandomStates random(98);
  const CameraModel camera = *CameraModel::Create(DistortionModel::kNone, {400, 410, 320, 240}, {}, 640, 480);
  const CameraModel tangent = camera.WithPlane(ObservationPlane::kTangent);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector3d p_W = random.Vector(3);
    const std::vector<Pose> views = random.CamerasLookingAt(p_W, 4, 6, 1.5);
    MatrixXd information[2];
    for (int k = 0; k < 2; ++k) {
      std::vector<NormalizedObservation> observations(views.size());
      for (size_t i = 0; i < views.size(); ++i) {
        Vector2d pixel;
        ASSERT_TRUE(camera.Project(views[i].Inverse() * p_W, &pixel));
        ASSERT_TRUE(NormalizeObservation(k == 0 ? camera : tangent, pixel, 1.5, &observations[i]));
        ASSERT_EQ(observations[i].plane.is_tangent(), k == 1);
      }
      TrackLinearization track;
      ASSERT_TRUE(LinearizeTrack(views, observations, p_W, &track));
      MatrixXd rows = MatrixXd::Zero(8, 24);
      for (Eigen::Index i = 0; i < 4; ++i) {
        rows.block<2, 6>(2 * i, 6 * i) = track.pose_jacobians.middleRows<2>(2 * i);
      }
      EliminateLandmark(track.point_jacobian, rows, track.residual);
      information[k] = rows.bottomRows(5).transpose() * rows.bottomRows(5);
    }
    EXPECT_LT((information[0] - information[1]).norm(), 1e-9 * information[0].norm());
  }
}

}  // namespace
}  // namespace alidade
