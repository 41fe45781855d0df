#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/preset_run.h"

namespace alidade {
namespace {

/// A walk at 0.8 m/s of which one track in seven is wrong from its first frames on.
Dataset WithWrongTracks(const std::string& kind, int duration_s, unsigned seed) {
  const Result<SimulatorConfig> sim =
      LoadSimulatorConfig(ALIDADE_SOURCE_DIR "/configs/datasets/figure8.yaml",
                          {"trajectory=wander", "duration_s=" + std::to_string(duration_s),
                           "path_m=" + std::to_string(4 * duration_s / 5), "max_features=80",
                           "outlier_rate=0.15", "outlier_unit=track", "outlier_kind=" + kind});
  EXPECT_TRUE(sim.ok()) << sim.message();
  return test::SimulateOrDie(sim.ok() ? *sim : SimulatorConfig(), seed);
}

/// Pose NEES of a preset with overrides, mean over `seeds` from `first` on. The start's velocity has a
/// deviation of 5 cm/s.
double MeanNees(const std::string& preset, const std::vector<std::string>& overrides, const std::string& kind,
                int duration_s, unsigned first, unsigned seeds) {
  constexpr double kStart = 5;
  double sum = 0;
  for (unsigned seed = first; seed < first + seeds; ++seed) {
    sum +=
        test::RunPreset(preset, overrides, WithWrongTracks(kind, duration_s, seed), seed, kStart).nees_pose;
  }
  return sum / seeds;
}

// GIVEN wrong tracks in a window of few frames, whose gates come after the solve THEN a kernel whose slope
// decreases leaves them without effect there, and one whose slope stays does not.
TEST(WrongTracks, DoNotBendTheStartOfTheSmoother) {
  for (const std::string kind : {"swap", "moving", "uniform"}) {
    const double log_tail = MeanNees("alidade_smoother", {}, kind, 5, 61, 4);
    EXPECT_LT(log_tail, 8.5) << kind;
    EXPECT_GT(MeanNees("alidade_smoother", {"vision.robust_kernel=huber"}, kind, 5, 61, 4), 1.5 * log_tail)
        << kind;
  }
}

// GIVEN landmarks that move WHEN the start's velocity is uncertain, so that the gate lets their tracks pass
// THEN they are refused because they do not fit the state that an update has found.
TEST(WrongTracks, DoNotBendTheStartOfTheFilter) {
  EXPECT_LT(MeanNees("alidade_filter", {}, "moving", 20, 97, 10), 100);  // 1636 where they are not
}

}  // namespace
}  // namespace alidade
