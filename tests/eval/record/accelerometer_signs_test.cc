#include "eval/record/accelerometer_signs.h"

#include <gtest/gtest.h>

#include "tests/support/scenario.h"

namespace alidade::test {
namespace {

MeasurementLog Flight(double rest_s) {
  SimulatorConfig simulation;
  simulation.duration_s = 25;
  simulation.rest_s = rest_s;
  simulation.path_m = rest_s < 20 ? 29 : 1;
  simulation.max_features = 80;
  const Dataset dataset = SimulateOrDie(simulation, 9);
  return {dataset.rig, dataset.imu, dataset.frames};
}

TEST(AccelerometerSignsTest, OnlyTheRightSignsStart) {
  const MeasurementLog log = Flight(3);
  for (const AccelerometerSigns& choice : SignChoices()) {
    EXPECT_EQ(StartsInMotion(EstimatorConfig(), WithSigns(log, choice.signs), nullptr),
              choice.signs == Eigen::Vector3d::Ones())
        << choice.name;
  }
}

TEST(AccelerometerSignsTest, AtRestNothingStarts) {
  MeasurementLog log = Flight(24);
  log.frames.resize(log.frames.size() * 9 / 10);
  EXPECT_FALSE(StartsInMotion(EstimatorConfig(), log, nullptr));
}

TEST(AccelerometerSignsTest, AStopEndsTheSearch) {
  const std::atomic<bool> stop = true;
  EXPECT_FALSE(StartsInMotion(EstimatorConfig(), Flight(3), &stop));
}

}  // namespace
}  // namespace alidade::test
