#include "gnss/positioning/single_point.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gnss/positioning/position_file.h"
#include "gnss/positioning/single_point_solution.h"
#include "tests/gnss/positioning/single_point_fixture.h"

namespace alidade {
namespace {

using testing::HasSubstr;

using test::kStamp;
using test::MakeSolver;
using test::NoIonosphere;
using test::Receiver;
using test::Thin;

void ExpectTruth(const SinglePointSolution& solution, const test::SyntheticReceiver& truth) {
  EXPECT_LT((solution.position_E - truth.position_E).norm(), 5e-3);
  ASSERT_TRUE(solution.has_velocity);
  EXPECT_LT((solution.velocity_E - truth.velocity_E).norm(), 2e-4);
  EXPECT_NEAR(solution.drift_mps, truth.drift_mps, 2e-4);
  // The tag is in whole nanoseconds.
  EXPECT_LE(std::abs(solution.stamp_ns - truth.stamp_ns), 1);
  EXPECT_NEAR(solution.clock_m, truth.clock_m, 0.3);
}

TEST(SinglePointTest, NoiseFreeEpochGivesTheTruthFromAnyStart) {
  const test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  const ObservationEpoch epoch = test::Observe(sky, receiver);
  for (const std::optional<Eigen::Vector3d>& start :
       {std::optional<Eigen::Vector3d>(), std::optional(receiver.position_E),
        std::optional(Eigen::Vector3d(-receiver.position_E)), std::optional(Eigen::Vector3d(1e3, 0, 0))}) {
    SinglePointSolver solver = MakeSolver(sky, start);
    const Result<SinglePointSolution> solution = solver.Solve(epoch);
    ASSERT_TRUE(solution.ok()) << solution.message();
    ExpectTruth(*solution, receiver);
    EXPECT_NEAR(*solution->inter_system_bias_m[static_cast<std::size_t>(GnssSystem::kGalileo)], 6.5, 5e-3);
    EXPECT_EQ(solution->scale, 1);
    EXPECT_GE(solution->used, 12);
  }
}

TEST(SinglePointTest, GIVEN_prepared_measurements_THEN_the_solution_is_that_of_the_epoch) {
  const test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  const ObservationEpoch epoch = test::Observe(sky, receiver);
  const MeasurementBuilder builder(std::make_shared<SatelliteCatalog>(sky), NoIonosphere());
  SinglePointSolver solver = MakeSolver(sky);
  SinglePointSolver other = MakeSolver(sky);
  const SinglePointSolution raw = solver.Solve(epoch).value();
  const SinglePointSolution prepared = other.Solve(builder.Prepare(epoch)).value();
  EXPECT_EQ(prepared.position_E, raw.position_E);
  EXPECT_EQ(prepared.velocity_E, raw.velocity_E);
  EXPECT_EQ(prepared.position_covariance_E, raw.position_covariance_E);
  EXPECT_EQ(prepared.clock_m, raw.clock_m);
  EXPECT_EQ(prepared.stamp_ns, raw.stamp_ns);
}

TEST(SinglePointTest, ReflectedSignalsAreRefusedAndNamed) {
  const test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  ObservationEpoch epoch = test::Observe(sky, receiver);
  const std::size_t reflected[] = {1, 4, 9};
  for (const std::size_t k : reflected) {
    *epoch.satellites.at(k).signals[0].pseudorange_m += 40 + 10.0 * static_cast<double>(k);
    *epoch.satellites.at(k).signals[0].doppler_hz += 25;
  }
  SinglePointSolver solver = MakeSolver(sky);
  const Result<SinglePointSolution> solution = solver.Solve(epoch);
  ASSERT_TRUE(solution.ok()) << solution.message();
  EXPECT_LT((solution->position_E - receiver.position_E).norm(), 0.1);
  EXPECT_LT((solution->velocity_E - receiver.velocity_E).norm(), 1e-3);
  for (const SatelliteResidual& s : solution->satellites) {
    const bool bad = std::any_of(std::begin(reflected), std::end(reflected),
                                 [&](std::size_t k) { return epoch.satellites[k].satellite == s.satellite; });
    const bool low = s.direction.elevation_rad < 10 * M_PI / 180;
    EXPECT_EQ(s.used, !bad && !low) << ToString(s.satellite);
    EXPECT_EQ(s.range_rate_used, !bad && !low) << ToString(s.satellite);
  }
}

// A third, or two of five, are late by 30 to 80 m: Huber's minimum alone is metres off.
TEST(SinglePointTest, ManyReflectionsAreOutvoted) {
  const test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  for (std::size_t turn = 0; turn < 8; ++turn) {
    ObservationEpoch epoch = test::Observe(sky, receiver);
    for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
      const bool late = turn < 5 ? k % 5 == turn || k % 5 == (turn + 2) % 5 : k % 3 == turn - 5;
      *epoch.satellites[k].signals[0].pseudorange_m += late ? 30 + 10.0 * static_cast<double>(k % 6) : 0;
    }
    SinglePointSolver solver = MakeSolver(sky);
    const Result<SinglePointSolution> solution = solver.Solve(epoch);
    ASSERT_TRUE(solution.ok()) << solution.message();
    EXPECT_LT((solution->position_E - receiver.position_E).norm(), 0.1) << turn;
  }
}

TEST(SinglePointTest, AMillisecondClockJumpLeavesThePosition) {
  test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  SinglePointSolver solver = MakeSolver(sky);
  ASSERT_TRUE(solver.Solve(test::Observe(sky, receiver)).ok());
  receiver.stamp_ns += kSecondNs;
  receiver.position_E += receiver.velocity_E;
  receiver.clock_m += 1e-3 * kSpeedOfLight;
  const Result<SinglePointSolution> solution = solver.Solve(test::Observe(sky, receiver));
  ASSERT_TRUE(solution.ok()) << solution.message();
  ExpectTruth(*solution, receiver);
}

TEST(SinglePointTest, EpochsThatCannotBeSolvedHaveAReason) {
  const test::SyntheticReceiver receiver = Receiver();
  NavigationData sky = test::SyntheticSky(kStamp);
  SinglePointSolver solver = MakeSolver(sky, receiver.position_E);
  EXPECT_THAT(solver.Solve(Thin(sky, receiver, 3, 0)).message(),
              HasSubstr("3 satellites can be used, expected 4"));
  EXPECT_THAT(solver.Solve(Thin(sky, receiver, 3, 0)).message(), HasSubstr("2020/06/24 23:59:59.999: "));
  EXPECT_THAT(solver.Solve(ObservationEpoch{kStamp, {}}).message(), HasSubstr("no satellite can be used"));
  for (auto& [id, list] : sky.kepler) {
    list[0].health = 63;
  }
  EXPECT_THAT(MakeSolver(sky).Solve(test::Observe(sky, receiver)).message(), HasSubstr("unhealthy"));
  // Four times one satellite is no geometry.
  sky = test::SyntheticSky(kStamp);
  const KeplerEphemeris one =
      sky.kepler[{GnssSystem::kGps, Thin(sky, receiver, 1, 0).satellites[0].satellite.number}][0];
  sky.kepler.clear();
  for (int number = 1; number <= 6; ++number) {
    KeplerEphemeris copy = one;
    copy.satellite.number = number;
    sky.kepler[copy.satellite] = {copy};
  }
  EXPECT_FALSE(MakeSolver(sky, receiver.position_E).Solve(test::Observe(sky, receiver)).ok());
}

TEST(SinglePointTest, AbsurdMeasurementsAreLeftOut) {
  const test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  ObservationEpoch epoch = test::Observe(sky, receiver);
  const double absurd[] = {1e300, -2e7, 1e-300, std::nan(""), 1e12};
  for (std::size_t k = 0; k < 5; ++k) {
    epoch.satellites.at(k).signals[0].pseudorange_m = absurd[k];
  }
  SinglePointSolver solver = MakeSolver(sky);
  const Result<SinglePointSolution> solution = solver.Solve(epoch);
  ASSERT_TRUE(solution.ok()) << solution.message();
  EXPECT_LT((solution->position_E - receiver.position_E).norm(), 0.02);
}

TEST(SinglePointTest, EqualInputGivesEqualBits) {
  const NavigationData sky = test::SyntheticSky(kStamp);
  const ObservationEpoch epoch = test::Observe(sky, Receiver());
  const SinglePointSolution a = MakeSolver(sky).Solve(epoch).value();
  const SinglePointSolution b = MakeSolver(sky).Solve(epoch).value();
  EXPECT_EQ(a.position_E, b.position_E);
  EXPECT_EQ(a.position_covariance_E, b.position_covariance_E);
  EXPECT_EQ(a.velocity_E, b.velocity_E);
}

TEST(SinglePointTest, IonosphereFreePairRemovesADispersiveDelay) {
  const test::SyntheticReceiver receiver = Receiver();
  NavigationData sky = test::SyntheticSky(kStamp);
  for (auto& [id, list] : sky.kepler) {
    list[0].group_delay_s = {0, 0};
  }
  ObservationEpoch epoch = test::Observe(sky, receiver);
  for (SatelliteObservation& s : epoch.satellites) {
    const double delay_m = 10 + s.satellite.number;
    const bool gps = s.satellite.system == GnssSystem::kGps;
    const double f2 = gps ? 1227.60 : 1176.45;
    SignalObservation second = s.signals[0];
    second.signal = gps ? SignalCode{'2', 'W'} : SignalCode{'5', 'Q'};
    *second.pseudorange_m += delay_m * 1575.42 * 1575.42 / (f2 * f2);
    *s.signals[0].pseudorange_m += delay_m;
    s.signals.push_back(second);
  }
  GnssCorrectionOptions options;
  options.ionosphere = IonosphereMode::kFree;
  const SinglePointSolution solution = MakeSolver(sky, std::nullopt, options).Solve(epoch).value();
  EXPECT_LT((solution.position_E - receiver.position_E).norm(), 0.02);
  EXPECT_GT((MakeSolver(sky).Solve(epoch).value().position_E - receiver.position_E).norm(), 1);
}

TEST(SinglePointTest, OptionsNameAnUnknownSystem) {
  GnssCorrectionOptions options;
  EXPECT_TRUE(options.Validate().ok());
  options.systems = "GX";
  EXPECT_THAT(options.Validate().message(), HasSubstr("found 'X'"));
}

TEST(PositionFileTest, IsRtklibsLayout) {
  SinglePointSolution solution;
  solution.stamp_ns = kStamp;
  solution.position_E = ToEcef({0.5, 1.0, 12.3456});
  const Eigen::Matrix3d R = EnuFrame::At(solution.position_E).R_EN;
  solution.position_covariance_E = R * Eigen::Vector3d(1, 4, 9).asDiagonal() * R.transpose();
  solution.velocity_E = R * Eigen::Vector3d(0.1, 0.2, 0.3);
  solution.used = 7;
  std::string text = PositionFileHeader({"program   : test"});
  AppendPosition(solution, &text);
  EXPECT_THAT(text, testing::StartsWith("% program   : test\n"));
  EXPECT_THAT(
      text, HasSubstr("\n2020/06/25 00:00:00.000   28.647889757   57.295779513    12.3456   5   7   2.0000   "
                      "1.0000   3.0000"));
  EXPECT_THAT(text, HasSubstr("    0.20000    0.10000    0.30000"));
}

}  // namespace
}  // namespace alidade
