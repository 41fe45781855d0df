#include "tests/support/sliding_tracks.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/preset_run.h"

namespace alidade {
namespace {

double NeesOf(const Dataset& dataset, unsigned seed, const std::string& preset,
              std::vector<std::string> overrides) {
  overrides.emplace_back("vision.pixel_noise_px=0.5");
  return test::RunPreset(preset, overrides, dataset, seed).nees_pose;
}

// GIVEN weights for ten times the tracks' noise WHEN the gate takes that noise too THEN sliding tracks pass,
// and the covariance is too small, unless the kernel's slope decreases; a gate at what most tracks show
// refuses them.
TEST(SlidingTracks, AGateAtTheNoiseOfMostTracksRefusesThem) {
  constexpr unsigned kSeed = 44;
  const Dataset dataset =
      test::SlidingTracks(kSeed, {"duration_s=30", "path_m=40", "outlier_rate=0.25", "outlier_px=3"});
  const std::string huber = "vision.robust_kernel=huber";
  EXPECT_LT(NeesOf(dataset, kSeed, "alidade_smoother", {}), 8);
  for (const std::string preset : {"alidade_filter", "alidade_smoother"}) {
    const double adaptive = NeesOf(dataset, kSeed, preset, {huber});
    EXPECT_LT(adaptive, 8) << preset;
    EXPECT_GT(NeesOf(dataset, kSeed, preset, {huber, "vision.gate_noise=given"}), 2 * adaptive) << preset;
  }
}

}  // namespace
}  // namespace alidade
