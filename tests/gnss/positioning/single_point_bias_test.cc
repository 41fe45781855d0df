#include <gtest/gtest.h>

#include "gnss/positioning/single_point_solution.h"
#include "tests/gnss/positioning/single_point_fixture.h"

// The receiver's clock and the biases between systems, when systems come and go.

namespace alidade {
namespace {

using test::kStamp;
using test::MakeSolver;
using test::NoIonosphere;
using test::Receiver;
using test::Thin;

TEST(SinglePointTest, CarriedInterSystemBiasSavesThinEpochs) {
  test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  SinglePointSolver fresh = MakeSolver(sky, receiver.position_E);
  EXPECT_FALSE(fresh.Solve(Thin(sky, receiver, 2, 2)).ok());
  SinglePointSolver solver = MakeSolver(sky, receiver.position_E);
  ASSERT_TRUE(solver.Solve(test::Observe(sky, receiver)).ok());
  receiver.stamp_ns += kSecondNs;
  receiver.position_E += receiver.velocity_E;
  receiver.clock_m += receiver.drift_mps;
  const Result<SinglePointSolution> thin = solver.Solve(Thin(sky, receiver, 2, 2));
  ASSERT_TRUE(thin.ok()) << thin.message();
  EXPECT_LT((thin->position_E - receiver.position_E).norm(), 0.02);
  // The datum stays GPS when no satellite of GPS is there.
  const Result<SinglePointSolution> galileo = solver.Solve(Thin(sky, receiver, 0, 5));
  ASSERT_TRUE(galileo.ok()) << galileo.message();
  EXPECT_NEAR(galileo->clock_m, receiver.clock_m, 0.5);
}

// GIVEN a solver without a place yet and whose datum, GPS, is all below the mask, THEN that is found out
// only after GPS has been the datum of a first fit, of which nothing may be left: the solution, and the one
// after it, are those of a solver that has not seen GPS.
TEST(SinglePointTest, ADatumThatIsMaskedLeavesNothingInTheClock) {
  constexpr double kSameM = 0.01;  // the bias is 40 m
  test::SyntheticReceiver receiver = Receiver();
  receiver.galileo_bias_m = 40;
  const NavigationData sky = test::SyntheticSky(kStamp);
  GnssCorrectionOptions options = NoIonosphere();
  options.elevation_mask_deg = 15;
  const EnuFrame frame = EnuFrame::At(receiver.position_E);
  ObservationEpoch masked = test::Observe(sky, receiver);
  std::erase_if(masked.satellites, [&](const SatelliteObservation& s) {
    const SatelliteState state = PropagateKepler(sky.kepler.at(s.satellite)[0], receiver.stamp_ns);
    return s.satellite.system == GnssSystem::kGps &&
           DirectionTo(frame, state.position_E).elevation_rad > 13 * M_PI / 180;
  });
  ObservationEpoch absent = masked;
  ASSERT_GT(
      std::erase_if(absent.satellites,
                    [](const SatelliteObservation& s) { return s.satellite.system == GnssSystem::kGps; }),
      0U);
  SinglePointSolver solver = MakeSolver(sky, std::nullopt, options);
  SinglePointSolver other = MakeSolver(sky, std::nullopt, options);
  const Result<SinglePointSolution> solution = solver.Solve(masked);
  const Result<SinglePointSolution> expected = other.Solve(absent);
  ASSERT_TRUE(solution.ok()) << solution.message();
  ASSERT_TRUE(expected.ok()) << expected.message();
  EXPECT_NEAR(solution->clock_m, expected->clock_m, kSameM);
  EXPECT_NEAR(solution->clock_m, receiver.clock_m + receiver.galileo_bias_m, 0.3);
  EXPECT_LE(std::abs(solution->stamp_ns - expected->stamp_ns), 1);
  EXPECT_LT((solution->position_E - expected->position_E).norm(), kSameM);
  EXPECT_EQ(solution->used, expected->used);
  EXPECT_EQ(solution->inter_system_bias_m, expected->inter_system_bias_m);  // none

  receiver.stamp_ns += kSecondNs;
  receiver.position_E += receiver.velocity_E;
  receiver.clock_m += receiver.drift_mps;
  const ObservationEpoch next = test::Observe(sky, receiver);
  const Result<SinglePointSolution> later = solver.Solve(next);
  const Result<SinglePointSolution> later_expected = other.Solve(next);
  ASSERT_TRUE(later.ok()) << later.message();
  ASSERT_TRUE(later_expected.ok()) << later_expected.message();
  EXPECT_NEAR(later->clock_m, later_expected->clock_m, kSameM);
  const std::size_t gps = SystemIndex(GnssSystem::kGps);
  ASSERT_TRUE(later->inter_system_bias_m[gps] && later_expected->inter_system_bias_m[gps]);
  EXPECT_NEAR(*later->inter_system_bias_m[gps], -receiver.galileo_bias_m, kSameM);
  EXPECT_NEAR(*later->inter_system_bias_m[gps], *later_expected->inter_system_bias_m[gps], kSameM);
}

}  // namespace
}  // namespace alidade
