#include "core/landmark_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "core/landmark_reduction.h"
#include "core/reprojection.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using test::RandomStates;

constexpr double kSigma = 3e-3;

struct Views {
  /// `noise_sigma` times kSigma, uniform in each direction.
  Views(RandomStates* random, int count, double noise_sigma) {
    point = random->Vector(5);
    T_WC = random->CamerasLookingAt(point, count, 6, 1.0);
    const double half_width = std::sqrt(3.0) * noise_sigma * kSigma;
    for (const Pose& view : T_WC) {
      const Vector3d p = view.Inverse() * point;
      const Vector2d noise(random->Uniform(-half_width, half_width),
                           random->Uniform(-half_width, half_width));
      observations.push_back({p.head<2>() / p.z() + noise, Eigen::Matrix2d::Identity() / kSigma});
    }
  }
  /// (x, y, rho) of a point in the base view.
  [[nodiscard]] Vector3d Anchored(const Vector3d& p_W) const {
    const Vector3d p = T_WC.front().Inverse() * p_W;
    return {p.x() / p.z(), p.y() / p.z(), 1 / p.z()};
  }

  Vector3d point;
  std::vector<Pose> T_WC;
  std::vector<NormalizedObservation> observations;
};

TEST(LandmarkSolverTest, WithoutNoiseTheSolutionIsTheLandmark) {
  RandomStates random(71);
  for (int trial = 0; trial < 20; ++trial) {
    const Views views(&random, 3 + trial % 4, 0);
    Vector3d p = views.point + random.Vector(0.5);
    ASSERT_TRUE(RefineLandmark(views.T_WC, views.observations, 20, &p));
    EXPECT_LT((p - views.point).norm(), 1e-7);
    Vector3d landmark = views.Anchored(views.point) + Vector3d(0.01, -0.02, 0.01);
    ASSERT_TRUE(SolveLandmark(views.T_WC, views.observations, {}, &landmark));
    EXPECT_LT((landmark - views.Anchored(views.point)).norm(), 1e-8);
  }
}

// How far the minimum is from the true point is the noise's doing, not the solver's: 6 m away, seen from
// within 2 m of each other, 0.003 on the normalised plane is up to 0.3 m in depth. So the solver is held to
// the gradient, in standard deviations of the landmark, and the landmark to its covariance.
TEST(LandmarkSolverTest, RefinementReachesTheMinimum) {
  RandomStates random(72);
  constexpr int kTrials = 200;
  double mean_nees = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Views views(&random, 5, 1);
    Vector3d p = views.point + random.Vector(0.5);
    ASSERT_TRUE(RefineLandmark(views.T_WC, views.observations, 20, &p));
    TrackLinearization at_minimum;
    ASSERT_TRUE(LinearizeTrack(views.T_WC, views.observations, p, &at_minimum));
    const Matrix3d information = at_minimum.point_jacobian.transpose() * at_minimum.point_jacobian;
    const Vector3d gradient = at_minimum.point_jacobian.transpose() * at_minimum.residual;
    EXPECT_LT(std::sqrt(gradient.dot(information.ldlt().solve(gradient))), 1e-6);
    mean_nees += (p - views.point).dot(information * (p - views.point)) / kTrials;
  }
  EXPECT_NEAR(mean_nees, 3, 4 * std::sqrt(6.0 / kTrials));
}

TEST(LandmarkSolverTest, NoStepFromTheSolutionLowersARobustCost) {
  RandomStates random(73);
  for (const RobustKernel kernel :
       {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy, RobustKernel::kLogTail}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Views views(&random, 6, 2);
      LandmarkOptions options;
      options.kernel = {kernel, 1.0};
      options.depth_prior = {0.2, 5};
      Vector3d landmark = views.Anchored(views.point);
      ASSERT_TRUE(SolveLandmark(views.T_WC, views.observations, options, &landmark));
      const double best = LandmarkCost(views.T_WC, views.observations, options, landmark);
      for (int i = 0; i < 3; ++i) {
        for (const double step : {-1e-4, 1e-4}) {
          EXPECT_GE(
              LandmarkCost(views.T_WC, views.observations, options, landmark + step * Vector3d::Unit(i)),
              best);
        }
      }
    }
  }
}

TEST(LandmarkSolverTest, APriorStandsInForParallax) {
  const std::vector<Pose> same(3);
  const std::vector<NormalizedObservation> observations(3,
                                                        {{0.1, 0.2}, Eigen::Matrix2d::Identity() / kSigma});
  LandmarkOptions options;
  options.depth_prior = {0.25, 4};
  Vector3d landmark(0, 0, 0.5);
  ASSERT_TRUE(SolveLandmark(same, observations, options, &landmark));
  EXPECT_LT((landmark - Vector3d(0.1, 0.2, 0.25)).norm(), 1e-9);
  EXPECT_NEAR(LandmarkCost(same, observations, options, {0.1, 0.2, 0.5}), 1, 1e-12);
}

TEST(LandmarkSolverTest, InfinityIsRegularUnlessAFiniteDepthIsAskedFor) {
  RandomStates random(74);
  std::vector<Pose> T_WC(3);
  std::vector<NormalizedObservation> observations(3);
  for (size_t k = 0; k < T_WC.size(); ++k) {
    // Lines that diverge: they meet behind the cameras.
    T_WC[k].translation = Vector3d(0.5 * static_cast<double>(k), 0, 0);
    observations[k].z = Vector2d(0.01 * static_cast<double>(k), 0);
  }
  Vector3d landmark(0, 0, 0.1);
  ASSERT_TRUE(SolveLandmark(T_WC, observations, {}, &landmark));
  EXPECT_NEAR(landmark.z(), -0.02, 1e-9);
  LandmarkOptions finite;
  finite.finite_depth = true;
  landmark = Vector3d(0, 0, 0.1);
  ASSERT_TRUE(SolveLandmark(T_WC, observations, finite, &landmark));
  EXPECT_GT(landmark.z(), 0);
  EXPECT_TRUE(std::isinf(LandmarkCost(T_WC, observations, finite, {0, 0, -0.02})));
}

TEST(LandmarkSolverTest, ALandmarkBehindAViewIsRefusedAndUntouched) {
  RandomStates random(75);
  Views views(&random, 3, 0);
  const Vector3d behind_base = 2 * views.T_WC[0].translation - views.point;
  Vector3d p = behind_base;
  EXPECT_FALSE(RefineLandmark(views.T_WC, views.observations, 20, &p));
  EXPECT_EQ(p, behind_base);
  views.T_WC[2].rotation = views.T_WC[2].rotation * so3::Exp(Vector3d(M_PI, 0, 0));
  p = views.point;
  EXPECT_FALSE(RefineLandmark(views.T_WC, views.observations, 20, &p));
  EXPECT_EQ(p, views.point);
  Vector3d landmark = views.Anchored(views.point);
  EXPECT_FALSE(SolveLandmark(views.T_WC, views.observations, {}, &landmark));
  EXPECT_TRUE(std::isinf(LandmarkCost(views.T_WC, views.observations, {}, landmark)));
}

TEST(LandmarkSolverTest, TriangulationFindsTheLandmarkOfExactViews) {
  RandomStates random(76);
  const Views views(&random, 5, 0);
  for (const DepthViews which : {DepthViews::kMulti, DepthViews::kTwo}) {
    PoseOnlyDepth depth;
    ASSERT_TRUE(TriangulateLandmark(views.T_WC, views.observations, which, 0.5, &depth));
    EXPECT_LT((depth.p_W - views.point).norm(), 1e-10);
    EXPECT_FALSE(TriangulateLandmark(views.T_WC, views.observations, which, 1e-6, &depth));
  }
}

// GIVEN a camera at rest whose bearings scatter by their noise, THEN the parallax of that noise is no depth,
// however long the track is and however lax the gate.
TEST(LandmarkSolverTest, ParallaxOfTheNoiseAloneIsNotADepth) {
  constexpr int kViews = 26;
  const std::vector<Pose> at_rest(kViews);
  std::vector<NormalizedObservation> observations(kViews, {{0, 0}, Eigen::Matrix2d::Identity() / kSigma});
  for (int i = 1; i < kViews; ++i) {  // |z_i - z_b| = 2 sigma, its root mean square
    observations[static_cast<size_t>(i)].z = 2 * kSigma * Vector2d(std::cos(i), std::sin(i));
  }
  PoseOnlyDepth depth;
  ASSERT_TRUE(ComputePoseOnlyDepth(at_rest, observations, 0, DepthViews::kMulti, &depth));
  EXPECT_LT(kSigma / std::sqrt(depth.normal), 0.11) << "it would pass a gate of 0.11";
  EXPECT_FALSE(TriangulateLandmark(at_rest, observations, DepthViews::kMulti, 10, &depth));
}

}  // namespace
}  // namespace alidade
