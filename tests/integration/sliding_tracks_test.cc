#include "tests/support/sliding_tracks.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "eval/config/config_yaml.h"
#include "filter/filter.h"
#include "smoother/sliding/smoother.h"
#include "tests/support/scenario.h"

namespace alidade {
namespace {

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
  const Dataset dataset =
      test::SlidingTracks(kSeed, {"duration_s=30", "path_m=40", "outlier_rate=0.25", "outlier_px=3"});
  for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
    const double adaptive = NeesOf(dataset, kSeed, preset, "adaptive");
    EXPECT_LT(adaptive, 8) << preset;
    EXPECT_GT(NeesOf(dataset, kSeed, preset, "given"), 2 * adaptive) << preset;
  }
}

}  // namespace
}  // namespace alidade
