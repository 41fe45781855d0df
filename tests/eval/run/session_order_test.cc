#include <gtest/gtest.h>

#include "eval/record/runner.h"
#include "eval/record/truth_start.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/eval/run/stream.h"

// The order in which messages arrive.

namespace alidade {
namespace {

using test::Only;

Dataset SimulateWalk() {
  SimulatorConfig config;
  config.duration_s = 9;
  config.path_m = 12;
  config.wobble_rad = 0.15;
  Result<Dataset> dataset = Simulate(config, 3);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return *dataset;
}

class SessionOrderTest : public testing::TestWithParam<Backend> {
 protected:
  static EstimatorConfig Config() {
    EstimatorConfig config;
    config.backend = GetParam();
    config.init.method = InitMethod::kTruth;
    config.calibration.time_offset = true;
    return config;
  }
};

// GIVEN samples that come 20 ms late and swapped and frames that come 60 to 240 ms late, of which many
// overtake each other, WHEN the lateness allows for it, THEN the states are those of the ordered log, bit by
// bit, whatever the seed of the delays.
TEST_P(SessionOrderTest, StatesAreThoseOfTheOrderedLog) {
  const Dataset dataset = SimulateWalk();
  const RunResult ordered =
      RunEstimator(Config(), {dataset.rig, dataset.imu, dataset.frames}, &*dataset.truth, 1);
  ASSERT_TRUE(ordered.status.ok()) << ordered.status.message();
  SessionOptions options;
  options.lateness = {0.01, 0.25, 0};
  options.start_state = [&](TimeNs imu_ns) {
    return StartFromTruth(Config().init, *dataset.truth, imu_ns, 1);
  };
  for (const unsigned seed : {1u, 2u, 3u}) {
    const std::vector<test::Arrival> arrivals =
        test::ArrivalsOf(dataset, {{0.02, 0.008}, {0.06, 0.18}, {}}, seed);
    size_t swapped = 0;
    size_t newest = 0;
    for (const test::Arrival& message : arrivals) {
      if (message.sensor == Sensor::kCamera) {
        swapped += message.index < newest ? 1 : 0;
        newest = std::max(newest, message.index);
      }
    }
    EXPECT_GT(swapped, 3u);
    Result<std::unique_ptr<Session>> session = Session::Make(Config(), dataset.rig, options);
    ASSERT_TRUE(session.ok()) << session.message();
    const std::vector<SessionEvent> events = test::Stream(session->get(), dataset, arrivals);
    EXPECT_TRUE(Only<TooLateEvent>(events).empty());
    const std::vector<NavEstimate> states = test::StatesOf(events);
    ASSERT_EQ(states.size(), ordered.records.size());
    for (size_t i = 0; i < states.size(); ++i) {
      ASSERT_TRUE(test::SameBits(states[i], ordered.records[i].estimate)) << "seed " << seed << ", row " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, SessionOrderTest,
                         testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& param) { return std::string(ToString(param.param)); });

// GIVEN a frame that comes when the next one was processed, THEN the session names the sensor, the stamp and
// the time by which it is late.
TEST(SessionLatenessTest, ReportsAFrameThatCameTooLate) {
  const Dataset dataset = SimulateWalk();
  Result<std::unique_ptr<Session>> session = Session::Make(EstimatorConfig(), dataset.rig);
  ASSERT_TRUE(session.ok()) << session.message();
  const TimeNs late_ns = dataset.frames[4].stamp_ns;
  for (const test::Arrival& message : test::ArrivalsOf(dataset, {}, 1)) {
    if (message.sensor == Sensor::kImu && message.arrival_ns <= late_ns + SecondsToNs(0.3)) {
      (*session)->AddImu(dataset.imu[message.index]);
    }
  }
  (*session)->AddFrame(dataset.frames[5]);
  EXPECT_TRUE(Only<TooLateEvent>((*session)->TakeEvents()).empty());
  (*session)->AddFrame(dataset.frames[4]);
  const auto late = Only<TooLateEvent>((*session)->TakeEvents());
  ASSERT_EQ(late.size(), 1u);
  EXPECT_EQ(late[0].sensor, Sensor::kCamera);
  EXPECT_EQ(late[0].stamp_ns, late_ns);
  EXPECT_NEAR(late[0].late_s, 0.1, 1e-6);
}

// GIVEN a lateness, THEN a frame is processed as soon as nothing that is awaited can come before it, and not
// earlier.
TEST(SessionLatenessTest, WaitsNoLongerThanTheLateness) {
  const Dataset dataset = SimulateWalk();
  SessionOptions options;
  options.lateness.camera_s = 0.05;
  Result<std::unique_ptr<Session>> session = Session::Make(EstimatorConfig(), dataset.rig, options);
  ASSERT_TRUE(session.ok()) << session.message();
  const TimeNs frame_ns = dataset.frames[0].stamp_ns;
  (*session)->AddFrame(dataset.frames[0]);
  for (const ImuSample& sample : dataset.imu) {
    (*session)->AddImu(sample);
    const bool processed = !(*session)->TakeEvents().empty();
    EXPECT_EQ(processed, sample.stamp_ns >= frame_ns + SecondsToNs(0.05));
    if (processed) {
      break;
    }
  }
}

}  // namespace
}  // namespace alidade
