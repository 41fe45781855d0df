#include <gtest/gtest.h>

#include <algorithm>

#include "smoother/factors/pose_only_cost.h"
#include "smoother/tracks/track_landmark.h"
#include "tests/smoother/window/calibrated_window.h"

// Explicit landmarks as PoseOnlyCost moves them.

namespace alidade::test {
namespace {

/// The point of a window with every pose, and what is estimated of the calibration, moved.
WindowPoint Shifted(WindowFixture* fixture) {
  WindowPoint point = PointOf(fixture->window, fixture->calibration.mean);
  for (NavState& state : point.states) {
    Vector9d shift;
    shift << fixture->random.Vector(3e-4), fixture->random.Vector(1e-3), Eigen::Vector3d::Zero();
    state = Retract(ErrorConvention::kSo3xRn, state, shift);
  }
  const Eigen::VectorXd error = Eigen::VectorXd::Constant(fixture->calibration.size(), 3e-6);
  EXPECT_TRUE(Retract(fixture->calibration.layout, error, &point.camera));
  return point;
}

/// Largest difference between the landmarks of two costs, the inverse depth in terms of itself.
double LargestDifference(const PoseOnlyCost& a, const PoseOnlyCost& b) {
  double largest = 0;
  for (size_t i = 0; i < a.landmarks().size(); ++i) {
    EXPECT_TRUE(a.landmarks()[i] && b.landmarks()[i]);
    Eigen::Vector3d difference = *a.landmarks()[i] - *b.landmarks()[i];
    difference.z() /= b.landmarks()[i]->z();
    largest = std::max(largest, difference.cwiseAbs().maxCoeff());
  }
  return largest;
}

// GIVEN explicit landmarks, linearised where their cost is least WHEN states and calibration move THEN the
// joint step and the landmark's own take them to where it is least again; its own alone does not.
TEST(JointLandmarkTest, FollowsTheStatesToItsLeastCost) {
  for (const unsigned seed : {6u, 7u, 8u}) {
    for (const bool calibrated : {false, true}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << (calibrated ? ", calibrated" : ""));
      WindowFixture fixture(seed, 6, 20, 0.7);
      if (calibrated) {
        const CalibrationEstimate estimate = CalibrateWindow(&fixture);
        fixture.calibration = {estimate.layout, estimate.mean};
      }
      const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.calibration.mean);
      for (auto& [id, track] : fixture.window.tracks()) {
        track.depth_prior = {0.15, id % 3 == 0 ? 30.0 : 0.0};
        ASSERT_TRUE(SolveLandmark(track.views, geometry, {}, 30, &track.landmark, track.depth_prior));
      }
      const auto cost = [&](LandmarkMotion motion) {
        return PoseOnlyCost(fixture.window, fixture.tracks(), fixture.calibration, {}, motion);
      };
      auto joint = cost(LandmarkMotion::kJointStep);
      (void)joint.Solve(PointOf(fixture.window, fixture.calibration.mean));
      NormalEquations equations;
      ASSERT_TRUE(joint.Linearize(&equations));
      const WindowPoint point = Shifted(&fixture);
      auto least = cost(LandmarkMotion::kSolved);
      auto alone = cost(LandmarkMotion::kJointStep);
      const double least_cost = least.Solve(point);
      EXPECT_NEAR(joint.Solve(point), least_cost, 1e-9 * least_cost);
      (void)alone.Solve(point);
      EXPECT_LT(LargestDifference(joint, least), 0.03 * LargestDifference(alone, least));
    }
  }
}

}  // namespace
}  // namespace alidade::test
