#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/preset_run.h"

namespace alidade {
namespace {

constexpr unsigned kSeed = 35;

/// Figure-8 at 1.3 m/s; of the observations, not of the tracks, a share is wrong.
Dataset WithWrongObservations(const std::string& kind, double share,
                              std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.end(), {"duration_s=20", "path_m=26", "outlier_unit=observation",
                                     "outlier_kind=" + kind, "outlier_rate=" + std::to_string(share)});
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/figure8.yaml", overrides);
  EXPECT_TRUE(sim.ok()) << sim.message();
  return test::SimulateOrDie(sim.ok() ? *sim : SimulatorConfig(), kSeed);
}

// GIVEN one observation in five wrong, so that nearly every track has some WHEN the gate refuses observations
// THEN the run is as accurate as one without; and WHEN it refuses tracks THEN few are left.
TEST(WrongObservations, CostTheirTracksNothing) {
  for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
    const test::ScenarioResult clean = test::RunPreset(preset, {}, WithWrongObservations("jump", 0), kSeed);
    for (const std::string kind : {"jump", "swap", "uniform"}) {
      const Dataset dataset = WithWrongObservations(kind, 0.2);
      const test::ScenarioResult by_observation = test::RunPreset(preset, {}, dataset, kSeed);
      EXPECT_LT(by_observation.rmse_position_m, 1.4 * clean.rmse_position_m) << preset << " " << kind;
      EXPECT_LT(by_observation.nees_pose, 12) << preset << " " << kind;
      const test::ScenarioResult by_track =
          test::RunPreset(preset, {"vision.gate_unit=track"}, dataset, kSeed);
      EXPECT_GT(by_track.rmse_position_m, 1.5 * by_observation.rmse_position_m) << preset << " " << kind;
    }
  }
}

// GIVEN a lens that sees beside itself WHEN a landmark of the prior is seen where it is not, so that it lies
// behind the tangent plane of the observation THEN that observation is dropped, and not the run.
TEST(WrongObservations, ALandmarkBehindOneDoesNotEndTheRun) {
  const std::vector<std::string> wide = {"focal_px=260", "distortion=equidistant", "distortion_1=-0.01",
                                         "camera_view=sideways", "max_features=80"};
  for (const std::string unit : {"observation", "track"}) {
    const test::ScenarioResult result = test::RunPreset("alidade_smoother", {"vision.gate_unit=" + unit},
                                                        WithWrongObservations("uniform", 0.1, wide), kSeed);
    EXPECT_EQ(result.frames, 201) << unit;
  }
}

}  // namespace
}  // namespace alidade
