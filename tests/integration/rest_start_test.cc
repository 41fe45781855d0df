#include <gtest/gtest.h>

#include <string>

#include "tests/support/preset_run.h"

namespace alidade {
namespace {

// GIVEN a rig at rest whose state has the uncertainty of its prior, the gyroscope's bias to 5e-3 rad/s,
// WHEN it moves off after some seconds THEN both back ends have not drifted meanwhile.
TEST(RestStart, AnUncertainBiasDoesNotHideRest) {
  SimulatorConfig sim;
  sim.rest_s = 5;
  sim.duration_s = 15;
  sim.path_m = 13;
  for (const unsigned seed : {411U, 412U, 413U}) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
      const test::ScenarioResult result = test::RunPreset(preset, {}, dataset, seed, 2.5);
      EXPECT_LT(result.nees_pose, 20) << preset << ", seed " << seed;
      EXPECT_LT(result.rmse_position_m, 0.15) << preset << ", seed " << seed;
    }
  }
}

// GIVEN many draws of the start, some of whose velocities contradict rest by chance, THEN rest is found all
// the same: without it the estimate moves on by its bias until the rig moves.
TEST(RestStart, NoDrawOfTheStartHidesRest) {
  SimulatorConfig sim;
  sim.rest_s = 2;
  sim.duration_s = 5;
  sim.path_m = 3;
  sim.imu_rate_hz = 200;
  sim.camera_rate_hz = 20;
  for (unsigned seed = 421; seed < 471; ++seed) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    EXPECT_LT(test::RunPreset("alidade_filter", {}, dataset, seed, 5).max_position_m, 0.15)
        << "seed " << seed;
  }
}

// GIVEN a rig that moves off from rest before scenery so far that the images show it half a second later THEN
// no zero velocity is measured meanwhile.
TEST(RestStart, FarSceneryDoesNotHideTheBeginningOfMotion) {
  SimulatorConfig sim;
  sim.rest_s = 2;
  sim.rest_ramp_s = 2;
  sim.duration_s = 12;
  sim.path_m = 12;
  sim.camera_rate_hz = 20;
  sim.focal_px = 260;
  sim.pixel_noise_px = 1.5;
  sim.landmark_min_distance_m = 10;
  sim.landmark_max_distance_m = 60;
  sim.max_range_m = 100;
  for (const unsigned seed : {414U, 415U, 416U}) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
      EXPECT_LT(test::RunPreset(preset, {"vision.pixel_noise_px=1.5"}, dataset, seed).nees_pose, 15)
          << preset << ", seed " << seed;
    }
  }
}

// GIVEN a rig that stops and turns about its camera, so that the tracks in view have no parallax, THEN their
// noise is not taken for a motion of the camera.
TEST(RestStart, ATurnAboutTheCameraDoesNotMoveIt) {
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/figure8.yaml",
                          {"trajectory=ellipse", "duration_s=30", "length_m=12", "width_m=8", "path_m=20",
                           "path_point=camera", "pause_s=10", "pause_period_s=15", "pause_turn_rad=3.14"});
  ASSERT_TRUE(sim.ok()) << sim.message();
  double sum = 0;
  for (const unsigned seed : {431U, 432U, 433U, 434U}) {
    sum += test::RunPreset("alidade_smoother", {}, test::SimulateOrDie(*sim, seed), seed).nees_pose;
  }
  EXPECT_LT(sum / 4, 7);
}

}  // namespace
}  // namespace alidade
