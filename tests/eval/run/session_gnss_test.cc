#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "eval/config/config_yaml.h"
#include "eval/record/runner.h"
#include "eval/record/truth_start.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "tests/eval/run/stream.h"

// Sessions with GNSS.

namespace alidade {
namespace {

using test::Only;

constexpr test::Delays kLive = {{0.02, 0.008}, {0.06, 0.13}, {0.2, 0.1}};

Dataset SimulateGnss(const std::vector<std::string>& settings) {
  const Result<SimulatorConfig> config = LoadSimulatorConfig(
      std::string(ALIDADE_SOURCE_DIR) + "/configs/datasets/gnss_figure8_short.yaml", settings);
  EXPECT_TRUE(config.ok()) << config.message();
  Result<Dataset> dataset = Simulate(*config, 1);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return *dataset;
}

const Dataset& Walk() {
  static const Dataset* const dataset =
      new Dataset(SimulateGnss({"duration_s=12", "path_m=48", "gnss.clock_jump_at_s=6"}));
  return *dataset;
}

EstimatorConfig Preset(const std::string& name) {
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators/" + name + ".yaml",
                          {"gnss.model_std_scale=0", "gnss.pseudorange_std_m=0.5", "init.method=truth"});
  EXPECT_TRUE(config.ok()) << config.message();
  return *config;
}

SessionOptions Options(const EstimatorConfig& config, const Dataset& dataset) {
  SessionOptions options;
  options.lateness = {0.01, 0.2, 0.4};
  options.gnss = SetupOf(*dataset.gnss);
  options.start_state = [init = config.init, &dataset](TimeNs imu_ns) {
    return StartFromTruth(init, *dataset.truth, imu_ns, 1);
  };
  return options;
}

std::vector<SessionEvent> StreamOf(const EstimatorConfig& config, const Dataset& dataset,
                                   const SessionOptions& options, unsigned seed) {
  Result<std::unique_ptr<Session>> session = Session::Make(config, dataset.rig, options);
  EXPECT_TRUE(session.ok()) << session.message();
  return test::Stream(session->get(), dataset, test::ArrivalsOf(dataset, kLive, seed));
}

class SessionGnssTest : public testing::TestWithParam<const char*> {};

// GIVEN GNSS that comes 0.2 to 0.3 s late, frames that overtake each other, and a jump of the receiver's
// clock, THEN the session aligns by itself, and its states are those of the ordered log, bit by bit in the
// ENU frame.
TEST_P(SessionGnssTest, AlignsAndGivesTheStatesOfTheOrderedLog) {
  const Dataset& dataset = Walk();
  const EstimatorConfig config = Preset(GetParam());
  const RunResult ordered =
      RunEstimator(config, {dataset.rig, dataset.imu, dataset.frames, {}, dataset.gnss}, &*dataset.truth, 1);
  ASSERT_TRUE(ordered.status.ok()) << ordered.status.message();
  ASSERT_TRUE(ordered.global.has_value()) << ordered.align_report;
  const std::vector<SessionEvent> events = StreamOf(config, dataset, Options(config, dataset), 1);
  EXPECT_TRUE(Only<TooLateEvent>(events).empty());
  const auto aligned = Only<AlignedEvent>(events);
  ASSERT_EQ(aligned.size(), 1u);
  EXPECT_EQ(aligned[0].global.stamp_ns, ordered.global->stamp_ns);
  EXPECT_EQ(aligned[0].global.yaw_rad, ordered.global->yaw_rad);
  test::ExpectStatesOfLog(ordered.records, aligned[0], test::StatesOf(events));
  EXPECT_FALSE(Only<SatellitesEvent>(events).empty());
  bool waited = false;
  for (const WaitingEvent& event : Only<WaitingEvent>(events)) {
    waited = waited || event.sought == Sought::kAlignment;
  }
  EXPECT_TRUE(waited);
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, SessionGnssTest, testing::Values("gvio", "gvins_class"),
                         [](const auto& param) { return std::string(param.param); });

// GIVEN no camera, THEN the session starts in the ENU frame from GNSS and IMU, and its states do not depend
// on the delays.
TEST(SessionWithoutCameraTest, StartsFromGnssAndTheOrderOfArrivalDoesNotMatter) {
  Dataset dataset =
      SimulateGnss({"duration_s=40", "path_m=600", "landmark_count=10", "gnss.outage_start_s=39"});
  dataset.frames.clear();
  const EstimatorConfig config = Preset("gnss_imu");
  const RunResult ordered =
      RunEstimator(config, {dataset.rig, dataset.imu, {}, {}, dataset.gnss}, nullptr, 1);
  ASSERT_TRUE(ordered.status.ok()) << ordered.status.message();
  SessionOptions options = Options(config, dataset);
  options.camera = false;
  for (const unsigned seed : {1u, 2u}) {
    const std::vector<SessionEvent> events = StreamOf(config, dataset, options, seed);
    ASSERT_EQ(Only<StartedEvent>(events).size(), 1u);
    EXPECT_EQ(Only<StartedEvent>(events)[0].method, "gnss");
    const std::vector<NavEstimate> states = test::StatesOf(events, Sensor::kGnss);
    ASSERT_EQ(states.size(), ordered.records.size());
    ASSERT_GT(states.size(), 20u);
    for (size_t i = 0; i < states.size(); ++i) {
      ASSERT_TRUE(test::SameBits(states[i], ordered.records[i].estimate)) << i;
    }
  }
}

// GIVEN no ephemerides at first, WHEN a catalog is added for later epochs, THEN the alignment waits for it.
TEST(SessionCatalogTest, EphemeridesMayComeLater) {
  const Dataset& dataset = Walk();
  const EstimatorConfig config = Preset("gvio");
  SessionOptions options = Options(config, dataset);
  options.gnss->catalog = nullptr;
  Result<std::unique_ptr<Session>> session = Session::Make(config, dataset.rig, options);
  ASSERT_TRUE(session.ok()) << session.message();
  const TimeNs from_ns = dataset.gnss->epochs[dataset.gnss->epochs.size() / 3].stamp_ns;
  (*session)->AddCatalog(from_ns, dataset.gnss->catalog);
  const std::vector<SessionEvent> events =
      test::Stream(session->get(), dataset, test::ArrivalsOf(dataset, kLive, 1));
  const auto aligned = Only<AlignedEvent>(events);
  ASSERT_EQ(aligned.size(), 1u);
  EXPECT_GT(aligned[0].global.stamp_ns, from_ns);
}

// GIVEN one epoch that comes a second late, when those after it were processed, THEN the session names it,
// and its states are those of the log without it.
TEST(SessionGnssLatenessTest, ReportsAnEpochThatCameTooLate) {
  const Dataset& dataset = Walk();
  const EstimatorConfig config = Preset("gvio");
  const SessionOptions options = Options(config, dataset);
  std::vector<test::Arrival> arrivals = test::ArrivalsOf(dataset, kLive, 1);
  const size_t late = dataset.gnss->epochs.size() / 2;
  for (test::Arrival& message : arrivals) {
    message.arrival_ns += message.sensor == Sensor::kGnss && message.index == late ? kSecondNs : 0;
  }
  std::stable_sort(arrivals.begin(), arrivals.end(), [](const test::Arrival& a, const test::Arrival& b) {
    return a.arrival_ns < b.arrival_ns;
  });
  Result<std::unique_ptr<Session>> session = Session::Make(config, dataset.rig, options);
  ASSERT_TRUE(session.ok()) << session.message();
  const std::vector<SessionEvent> events = test::Stream(session->get(), dataset, arrivals);
  const auto refused = Only<TooLateEvent>(events);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].sensor, Sensor::kGnss);
  EXPECT_GT(refused[0].late_s, 0.3);
  EXPECT_LT(refused[0].late_s, 1);

  Dataset without = dataset;
  auto gnss = std::make_shared<GnssLog>(*dataset.gnss);
  EXPECT_LT(std::abs(SecondsBetween(gnss->epochs[late].stamp_ns, refused[0].stamp_ns)), 0.1);
  gnss->epochs.erase(gnss->epochs.begin() + static_cast<std::ptrdiff_t>(late));
  without.gnss = gnss;
  const std::vector<NavEstimate> expected = test::StatesOf(StreamOf(config, without, options, 1));
  const std::vector<NavEstimate> states = test::StatesOf(events);
  ASSERT_EQ(states.size(), expected.size());
  for (size_t i = 0; i < states.size(); ++i) {
    ASSERT_TRUE(test::SameBits(states[i], expected[i])) << i;
  }
}

// GIVEN epochs with numbers that are none, THEN those are left out, and the estimate goes on.
TEST(SessionGnssNumbersTest, WhatIsNoNumberIsLeftOut) {
  Dataset dataset = Walk();
  auto gnss = std::make_shared<GnssLog>(*dataset.gnss);
  int spoilt = 0;
  for (size_t i = 0; i < gnss->epochs.size(); i += 3) {
    for (SatelliteObservation& satellite : gnss->epochs[i].satellites) {
      for (SignalObservation& signal : satellite.signals) {
        switch (spoilt++ % 5) {
          case 0:
            signal.doppler_hz = std::nan("");
            break;
          case 1:
            signal.doppler_std_hz = 0;
            break;
          case 2:
            signal.pseudorange_std_m = std::nan("");
            break;
          case 3:
            signal.pseudorange_m = INFINITY;
            break;
          default:
            signal.cn0_dbhz = std::nan("");
            break;
        }
      }
    }
  }
  ASSERT_GT(spoilt, 50);
  dataset.gnss = gnss;
  for (const char* name : {"gvio", "gvins_class"}) {
    const EstimatorConfig config = Preset(name);
    const std::vector<SessionEvent> events = StreamOf(config, dataset, Options(config, dataset), 1);
    EXPECT_EQ(Only<AlignedEvent>(events).size(), 1u) << name;
    EXPECT_TRUE(Only<LostEvent>(events).empty()) << name;
    EXPECT_TRUE(Only<FailedEvent>(events).empty()) << name;
    EXPECT_FALSE(Only<SatellitesEvent>(events).empty()) << name;
  }
}

// GIVEN a receiver whose clock steps by what is no whole number of milliseconds, THEN GNSS is in use again
// after it, in either back end.
TEST(SessionGnssClockTest, AStepOfAnySizeIsSurvived) {
  Dataset dataset = Walk();
  auto gnss = std::make_shared<GnssLog>(*dataset.gnss);
  for (size_t i = 3 * gnss->epochs.size() / 4; i < gnss->epochs.size(); ++i) {
    for (SatelliteObservation& satellite : gnss->epochs[i].satellites) {
      for (SignalObservation& signal : satellite.signals) {
        if (signal.pseudorange_m) {
          *signal.pseudorange_m += 40123.4;
        }
      }
    }
  }
  dataset.gnss = gnss;
  for (const char* name : {"gvio", "gvins_class"}) {
    const EstimatorConfig config = Preset(name);
    const std::vector<SessionEvent> events = StreamOf(config, dataset, Options(config, dataset), 1);
    const auto judged = Only<SatellitesEvent>(events);
    ASSERT_FALSE(judged.empty()) << name;
    const auto& last = judged.back().residuals;
    EXPECT_GT(SecondsBetween(dataset.frames.front().stamp_ns, last.stamp_ns), 11) << name;
    const auto used = std::count_if(last.satellites.begin(), last.satellites.end(),
                                    [](const SatelliteResidual& satellite) { return satellite.used; });
    EXPECT_GT(used, 5) << name;
    EXPECT_TRUE(Only<LostEvent>(events).empty()) << name;
    const NavEstimate end = test::StatesOf(events).back();
    const Result<TrajectoryPoint> truth = InterpolateTruth(*dataset.truth, end.stamp_ns);
    ASSERT_TRUE(truth.ok());
    EXPECT_LT((end.nav.p_WB - truth->nav.p_WB).norm(), 1.5) << name;
  }
}

}  // namespace
}  // namespace alidade
