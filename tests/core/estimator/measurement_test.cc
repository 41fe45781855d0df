#include "core/estimator/measurement.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

constexpr Sensor kFix = SensorOf<PositionFixEntry>();

TEST(MeasurementTest, AnEntryNamesItsSensor) {
  EXPECT_EQ(ToString(kFix), PositionFixEntry::kKey);
  EXPECT_EQ(SensorOf(Measurement(PositionFix())), kFix);
  EXPECT_EQ(MeasurementKeys(), "fix");
}

TEST(MeasurementTest, TheAntennaOfTheReceiverIsWatchedBeforeThatOfTheOnlyPositionSensor) {
  EstimatorConfig config;
  config.gnss.enabled = config.fix.enabled = true;
  RigCalibration rig;
  EXPECT_EQ(AntennaToWatch(config, rig), std::nullopt);
  rig.fixes.resize(2);
  EXPECT_EQ(AntennaToWatch(config, rig), std::nullopt);
  rig.fixes.resize(1);
  EXPECT_EQ(AntennaToWatch(config, rig), kFix);
  rig.gnss.is_present = true;
  EXPECT_EQ(AntennaToWatch(config, rig), Sensor::kGnss);
  config.gnss.enabled = false;
  EXPECT_EQ(AntennaToWatch(config, rig), kFix);
  config.fix.enabled = false;
  EXPECT_EQ(AntennaToWatch(config, rig), std::nullopt);
}

}  // namespace
}  // namespace alidade
