#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "eval/simulation/simulator.h"
#include "tests/eval/record/gnss_scene.h"

// What calibration.watch reports of GNSS and position fixes, with both back ends.

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr double kFaultS = 20;
constexpr unsigned kSeed = 961;

enum class Absolute { kGnss, kFixes };

SimulatorConfig Scene(Absolute sensor) {
  SimulatorConfig config = test::GnssScene(45);
  config.fault_start_s = kFaultS;
  config.fault_duration_s = 1000;
  if (sensor == Absolute::kGnss) {
    config.gnss.rate_hz = 5;
  } else {
    config.fix.rate_hz = 5;
    config.fix.std_m = 0.5;
  }
  return config;
}

class GnssWatchRunTest : public testing::TestWithParam<Backend> {
 protected:
  static RunResult Run(const SimulatorConfig& simulation) {
    const Result<Dataset> dataset = Simulate(simulation, kSeed);
    EXPECT_TRUE(dataset.ok()) << dataset.message();
    EstimatorConfig config = test::GnssEstimator(GetParam());
    config.calibration.watch = true;
    config.gnss.enabled = simulation.gnss.rate_hz > 0;
    config.fix.enabled = simulation.fix.rate_hz > 0;
    RunResult result = test::RunWithSensors(config, *dataset, kSeed);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    return result;
  }

  /// Seconds after the start of the run at which the first record has this in its reason; -1: none has.
  static double FirstReported(const RunResult& result, const char* what) {
    for (const RunRecord& record : result.records) {
      if (record.reason.find(what) != std::string::npos) {
        return SecondsBetween(result.records.front().estimate.stamp_ns, record.estimate.stamp_ns);
      }
    }
    return -1;
  }
};

TEST_P(GnssWatchRunTest, ReportsNothingOfGnssThatIsAsGiven) {
  for (const Absolute sensor : {Absolute::kGnss, Absolute::kFixes}) {
    const RunResult result = Run(Scene(sensor));
    for (const RunRecord& record : result.records) {
      ASSERT_NE(record.status, "degraded") << record.reason;
    }
  }
}

TEST_P(GnssWatchRunTest, NamesALeverArmThatIsOffByHalfAMetre) {
  for (const Absolute sensor : {Absolute::kGnss, Absolute::kFixes}) {
    SimulatorConfig scene = Scene(sensor);
    scene.calibration_antenna_error_m = 0.5;
    const RunResult result = Run(scene);
    EXPECT_EQ(result.records.back().status, "degraded");
    EXPECT_THAT(
        result.records.back().reason,
        HasSubstr(sensor == Absolute::kGnss ? "the lever arm of the GNSS antenna is not as given"
                                            : "the lever arm of the position sensor is not as given"));
  }
}

// GIVEN positions pulled off at 0.5 m/s, THEN it is reported before 10 m that they contradict vision and IMU.
TEST_P(GnssWatchRunTest, DetectsAPull) {
  SimulatorConfig with_rates = Scene(Absolute::kGnss);
  with_rates.fault = SimFaultKind::kGnssRamp;
  SimulatorConfig without = Scene(Absolute::kGnss);
  without.fault = SimFaultKind::kGnssRampNoRates;
  SimulatorConfig fixes = Scene(Absolute::kFixes);
  fixes.fault = SimFaultKind::kGnssRamp;
  for (const SimulatorConfig& scene : {with_rates, without, fixes}) {
    const double reported_s = FirstReported(Run(scene), "contradict");
    EXPECT_GT(reported_s, kFaultS);
    EXPECT_LT(reported_s, kFaultS + 20);
  }
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, GnssWatchRunTest,
                         testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& of) { return of.param == Backend::kFilter ? "filter" : "smoother"; });

}  // namespace
}  // namespace alidade
