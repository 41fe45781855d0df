#include "smoother/sliding/newest_update.h"

#include <gtest/gtest.h>

#include "core/imu_propagation.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

/// At rest; the position known to 1 m, the rest as good as exactly.
NewestUpdate AtRest() {
  NavEstimate state;
  state.covariance = 1e-12 * Matrix15d::Identity();
  state.covariance.block<3, 3>(3, 3) = Eigen::Matrix3d::Identity();
  ClockState clock;
  clock.covariance = Matrix6d::Identity();
  NewestUpdate update;
  update.Begin(state, clock, Eigen::Matrix<double, 6, 15>::Zero());
  return update;
}

/// Of the position, 1 m along x from where the state is, known to 1 m.
FrameMeasurement FixAhead() {
  FrameMeasurement fix;
  fix.measurement = *MakeFixMeasurement({}, Vector3d::Zero(), {0, 0, Vector3d::UnitX()});
  return fix;
}

Status CarryAtRest(NewestUpdate* update) {
  std::vector<ImuSample> interval;
  for (int i = 0; i <= 10; ++i) {
    interval.push_back({i * 10'000'000LL, Vector3d::Zero(), Vector3d(0, 0, 9.81)});
  }
  return update->Carry(interval, ImuNoise(), GravityInWorld(9.81), {});
}

// GIVEN a fix that is attached to the newest frame, WHEN the next fix has a frame of its own, THEN its
// correction is what the first left: 1/2, then 1/3 of the remaining 1/2.
TEST(NewestUpdateTest, CarryKeepsTheCorrectionsBeforeIt) {
  NewestUpdate update = AtRest();
  const AbsoluteCorrection first = update.Add(FixAhead(), GravityInWorld(9.81));
  EXPECT_NEAR(first.change.x(), 0.5, 1e-3);
  ASSERT_TRUE(CarryAtRest(&update).ok());
  const AbsoluteCorrection second = update.Add(FixAhead(), GravityInWorld(9.81));
  EXPECT_NEAR(second.change.x(), 1.0 / 6, 1e-3);
  EXPECT_NEAR(second.covariance(0, 0), 1.0 / 6, 1e-3);
  EXPECT_NEAR(second.nav.p_WB.x(), 2.0 / 3, 1e-3);
}

}  // namespace
}  // namespace alidade
