#include "gnss/positioning/single_point.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "gnss/positioning/position_file.h"
#include "gnss/positioning/single_point_options.h"
#include "gnss/positioning/single_point_solution.h"
#include "tests/gnss/model/synthetic_sky.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr TimeNs kStamp = 1'593'043'200 * kSecondNs;

GnssCorrectionOptions NoIonosphere() {
  GnssCorrectionOptions options;
  options.ionosphere = IonosphereMode::kNone;
  return options;
}

SinglePointSolver MakeSolver(const NavigationData& sky, std::optional<Eigen::Vector3d> start = std::nullopt,
                             GnssCorrectionOptions options = NoIonosphere()) {
  return {MeasurementBuilder(std::make_shared<SatelliteCatalog>(sky), std::move(options)),
          SinglePointOptions(), start};
}

test::SyntheticReceiver Receiver() {
  test::SyntheticReceiver receiver;
  receiver.stamp_ns = kStamp;
  receiver.velocity_E = {3, -8, 1};
  receiver.clock_m = -271'828.18;
  receiver.drift_mps = 31.4;
  receiver.galileo_bias_m = 6.5;
  return receiver;
}

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

// A third of them is late by 30 to 80 m: Huber's minimum alone is metres off.
TEST(SinglePointTest, ManyReflectionsAreOutvoted) {
  const test::SyntheticReceiver receiver = Receiver();
  const NavigationData sky = test::SyntheticSky(kStamp);
  for (int turn = 0; turn < 3; ++turn) {
    ObservationEpoch epoch = test::Observe(sky, receiver);
    for (std::size_t k = 0; k < epoch.satellites.size(); ++k) {
      const bool late = k % 3 == static_cast<std::size_t>(turn);
      *epoch.satellites[k].signals[0].pseudorange_m += late ? 30 + 10.0 * static_cast<double>(k % 6) : 0;
    }
    SinglePointSolver solver = MakeSolver(sky);
    const Result<SinglePointSolution> solution = solver.Solve(epoch);
    ASSERT_TRUE(solution.ok()) << solution.message();
    EXPECT_LT((solution->position_E - receiver.position_E).norm(), 0.1) << turn;
  }
}

/// Keeps so many satellites of GPS and Galileo above 15 deg, spread in azimuth.
ObservationEpoch Thin(const NavigationData& sky, const test::SyntheticReceiver& receiver, std::size_t gps,
                      std::size_t galileo) {
  ObservationEpoch epoch = test::Observe(sky, receiver);
  const EnuFrame frame = EnuFrame::At(receiver.position_E);
  std::map<GnssSystem, std::map<double, SatelliteId>> by_azimuth;
  for (const SatelliteObservation& s : epoch.satellites) {
    const SatelliteState state = PropagateKepler(sky.kepler.at(s.satellite)[0], receiver.stamp_ns);
    const Direction direction = DirectionTo(frame, state.position_E);
    if (direction.elevation_rad > 15 * M_PI / 180) {
      by_azimuth[s.satellite.system][direction.azimuth_rad] = s.satellite;
    }
  }
  std::set<SatelliteId> kept;
  for (const auto& [system, satellites] : by_azimuth) {
    const std::size_t count = system == GnssSystem::kGps ? gps : galileo;
    for (std::size_t i = 0; i < count; ++i) {
      kept.insert(
          std::next(satellites.begin(), static_cast<std::ptrdiff_t>(i * satellites.size() / count))->second);
    }
  }
  std::erase_if(epoch.satellites, [&](const SatelliteObservation& s) { return !kept.contains(s.satellite); });
  return epoch;
}

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

// GIVEN a solver that knows no place yet and whose datum, GPS, is all below the mask, THEN that is found out
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

TEST(SinglePointTest, EpochsThatCannotBeSolvedSayWhy) {
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
