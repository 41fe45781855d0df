#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "eval/config/config_yaml.h"
#include "filter/filter.h"
#include "smoother/sliding/smoother.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

/// Tracks of 0.05 px, of which a quarter slides by some pixels a second, as where a near edge crosses a far
/// texture.
Dataset SlidingTracks(unsigned seed) {
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/gnss_rendered.yaml",
                          {"render.enabled=false", "gnss.rate_hz=0", "rest_s=0", "duration_s=30", "path_m=40",
                           "landmark_layout=room", "landmark_count=600", "max_range_m=60",
                           "pixel_noise_px=0.05", "outlier_rate=0.25", "outlier_kind=drift", "outlier_px=3"});
  EXPECT_TRUE(sim.ok()) << sim.message();
  return test::SimulateOrDie(*sim, seed);
}

double NeesOf(const Dataset& dataset, unsigned seed, const std::string& preset,
              const std::string& gate_noise) {
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/" + preset + ".yaml",
                          {"vision.pixel_noise_px=0.5", "vision.gate_noise=" + gate_noise});
  EXPECT_TRUE(config.ok()) << config.message();
  const std::unique_ptr<Estimator> estimator = config->backend == Backend::kFilter
                                                   ? MakeFilter(*config, dataset.rig)
                                                   : MakeSmoother(*config, dataset.rig);
  const test::ScenarioResult result =
      test::RunScenario(dataset, test::DrawInitialState(dataset, seed), estimator.get());
  EXPECT_TRUE(result.status.ok()) << result.status.message();
  return result.nees_pose;
}

// GIVEN weights for ten times the tracks' noise WHEN the gate takes that noise too THEN sliding tracks pass,
// and the covariance is too small; a gate at what most tracks show refuses them.
TEST(SlidingTracks, AGateAtTheNoiseOfMostTracksRefusesThem) {
  constexpr unsigned kSeed = 44;
  const Dataset dataset = SlidingTracks(kSeed);
  for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
    const double adaptive = NeesOf(dataset, kSeed, preset, "adaptive");
    EXPECT_LT(adaptive, 8) << preset;
    EXPECT_GT(NeesOf(dataset, kSeed, preset, "given"), 2 * adaptive) << preset;
  }
}

}  // namespace
}  // namespace alidade
