#include <gtest/gtest.h>

#include "tests/support/preset_run.h"

// The same motion, kilometres from the origin of W.

namespace alidade {
namespace {

const Eigen::Vector3d kFar(4000, -3000, 200);
// Rounding at that distance, which smoothers' solvers carry on up to their tolerance.
constexpr double kTolerance = 1e-4;

class FarOrigin : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Presets, FarOrigin,
                         ::testing::Values("alidade_filter", "alidade_smoother", "invio_l10_all",
                                           "openvins_class", "pockf", "po_invio_two", "vins_mono_class"));

// GIVEN a world whose origin is far away THEN estimates and their covariance are those near the origin: what
// a right-invariant correction neglects must not grow with the distance.
TEST_P(FarOrigin, GivesTheSameEstimates) {
  SimulatorConfig sim;
  sim.duration_s = 8;
  sim.path_m = 10;
  const Dataset near = test::SimulateOrDie(sim, 81);
  Dataset far = near;
  for (TrajectoryPoint& point : far.truth->points) {
    point.nav.p_WB += kFar;
  }
  const test::ScenarioResult at_origin = test::RunPreset(GetParam(), {}, near, 81);
  const test::ScenarioResult away = test::RunPreset(GetParam(), {}, far, 81);
  ASSERT_GT(at_origin.frames, 70);
  ASSERT_EQ(away.frames, at_origin.frames);
  EXPECT_NEAR(away.nees_pose, at_origin.nees_pose, kTolerance * at_origin.nees_pose);
  EXPECT_NEAR(away.rmse_position_m, at_origin.rmse_position_m, kTolerance * at_origin.rmse_position_m);
  EXPECT_NEAR(away.rmse_orientation_rad, at_origin.rmse_orientation_rad,
              kTolerance * at_origin.rmse_orientation_rad);
  const Eigen::MatrixXd& near_covariance = at_origin.last.covariance;
  EXPECT_LT((away.last.covariance - near_covariance).norm(), kTolerance * near_covariance.norm());
}

}  // namespace
}  // namespace alidade
