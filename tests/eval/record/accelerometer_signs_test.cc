#include "eval/record/accelerometer_signs.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/scenario.h"

namespace alidade::test {
namespace {

MeasurementLog Flight(double rest_s) {
  SimulatorConfig simulation;
  simulation.duration_s = 22 + rest_s;
  simulation.rest_s = rest_s;
  simulation.path_m = 29;
  simulation.max_features = 80;
  const Dataset dataset = SimulateOrDie(simulation, 9);
  return {dataset.rig, dataset.imu, dataset.frames};
}

// Two negated axes are half a turn of the accelerometer, which short windows do not exclude: a run decides.
TEST(AccelerometerSignsTest, OneNegatedAxisOrAllOfThemDoNotStart) {
  const MeasurementLog log = Flight(3);
  for (const AccelerometerSigns& choice : SignChoices()) {
    if (const double product = choice.signs.prod(); product < 0) {
      EXPECT_FALSE(StartsInMotion(EstimatorConfig(), WithSigns(log, choice.signs), nullptr)) << choice.name;
    }
  }
  EXPECT_TRUE(StartsInMotion(EstimatorConfig(), log, nullptr));
}

TEST(AccelerometerSignsTest, AtRestNothingStarts) {
  MeasurementLog log = Flight(30);
  std::erase_if(log.frames, [&log](const TrackFrame& frame) {
    return SecondsBetween(log.imu.front().stamp_ns, frame.stamp_ns) > 28;
  });
  EXPECT_FALSE(StartsInMotion(EstimatorConfig(), log, nullptr));
}

TEST(AccelerometerSignsTest, AStopEndsTheSearch) {
  const std::atomic<bool> stop = true;
  EXPECT_FALSE(StartsInMotion(EstimatorConfig(), Flight(3), &stop));
}

}  // namespace
}  // namespace alidade::test
