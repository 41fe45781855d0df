#include "eval/run/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "tests/eval/run/stream.h"

namespace alidade {
namespace {

using test::Only;
using testing::HasSubstr;

constexpr test::Delays kLive = {{0.02, 0}, {0.06, 0}, {0.2, 0}};

SimulatorConfig Walk(double duration_s) {
  SimulatorConfig config;
  config.duration_s = duration_s;
  config.path_m = 1.31 * duration_s;
  config.wobble_rad = 0.15;
  return config;
}

Dataset SimulateWalk(const SimulatorConfig& config, unsigned seed) {
  Result<Dataset> dataset = Simulate(config, seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return dataset.ok() ? *dataset : Dataset();
}

SessionOptions LiveOptions() {
  SessionOptions options;
  options.lateness = {0.01, 0.1, 0.3};
  return options;
}

std::unique_ptr<Session> MakeSession(const EstimatorConfig& config, const Dataset& dataset,
                                     const SessionOptions& options = LiveOptions()) {
  Result<std::unique_ptr<Session>> session = Session::Make(config, dataset.rig, options);
  EXPECT_TRUE(session.ok()) << session.message();
  return session.ok() ? std::move(*session) : nullptr;
}

/// With the true state given.
EstimatorConfig GivenConfig() {
  EstimatorConfig config;
  config.init.method = InitMethod::kTruth;
  return config;
}
SessionOptions GivenOptions(const Dataset& dataset) {
  SessionOptions options = LiveOptions();
  options.start_state = [&dataset](TimeNs imu_ns) -> Result<NavEstimate> {
    const Result<TrajectoryPoint> truth = InterpolateTruth(*dataset.truth, imu_ns);
    ALIDADE_RETURN_IF_ERROR(truth.status());
    NavEstimate start{imu_ns, truth->nav, truth->bias, {}};
    start.covariance = 1e-4 * Matrix15d::Identity();
    return start;
  };
  return options;
}

/// A session that runs, after the first `seconds` of the walk.
std::unique_ptr<Session> Started(const Dataset& dataset, double seconds) {
  std::unique_ptr<Session> session = MakeSession(GivenConfig(), dataset, GivenOptions(dataset));
  for (const test::Arrival& message : test::ArrivalsOf(dataset, kLive, 1)) {
    if (SecondsBetween(dataset.imu.front().stamp_ns, message.arrival_ns) < seconds) {
      test::AddTo(session.get(), dataset, message);
    }
  }
  EXPECT_TRUE(session->running());
  return session;
}

// GIVEN a rig in motion of which nothing is known, WHEN its messages come, THEN the session reports what it
// waits for, starts by itself and reports a state for each frame from then on.
TEST(SessionTest, StartsByItself) {
  const Dataset dataset = SimulateWalk(Walk(10), 1);
  const std::unique_ptr<Session> session = MakeSession(EstimatorConfig(), dataset);
  const std::vector<SessionEvent> events =
      test::Stream(session.get(), dataset, test::ArrivalsOf(dataset, kLive, 1));
  const auto started = Only<StartedEvent>(events);
  ASSERT_EQ(started.size(), 1u);
  EXPECT_EQ(started[0].method, "dynamic");
  const auto waiting = Only<WaitingEvent>(events);
  ASSERT_FALSE(waiting.empty());
  EXPECT_FALSE(waiting[0].reason.empty());
  EXPECT_LT(waiting.back().stamp_ns, started[0].estimate.stamp_ns);
  const auto states = Only<StateEvent>(events);
  EXPECT_EQ(states.size() + waiting.size(), dataset.frames.size());
  EXPECT_EQ(states.front().message_ns, started[0].estimate.stamp_ns);
  EXPECT_GT(states.back().statistics.features_used, 5);
  EXPECT_TRUE(Only<FailedEvent>(events).empty());
  const Result<TrajectoryPoint> truth = InterpolateTruth(*dataset.truth, states.back().estimate.stamp_ns);
  ASSERT_TRUE(truth.ok());
  EXPECT_NEAR(states.back().estimate.nav.v_WB.norm(), truth->nav.v_WB.norm(), 0.2);

  // Whatever the order of arrival.
  const std::unique_ptr<Session> other = MakeSession(EstimatorConfig(), dataset);
  const std::vector<NavEstimate> swapped = test::StatesOf(
      test::Stream(other.get(), dataset, test::ArrivalsOf(dataset, {{0.02, 0.008}, {0.06, 0.05}, {}}, 2)));
  ASSERT_EQ(swapped.size(), states.size());
  for (size_t i = 0; i < swapped.size(); ++i) {
    ASSERT_TRUE(test::SameBits(swapped[i], states[i].estimate)) << i;
  }
}

TEST(SessionTest, StartsFromAGivenState) {
  const Dataset dataset = SimulateWalk(Walk(2), 1);
  EXPECT_THAT(Session::Make(GivenConfig(), dataset.rig).message(), HasSubstr("init.method"));
  const std::unique_ptr<Session> session = MakeSession(GivenConfig(), dataset, GivenOptions(dataset));
  const std::vector<SessionEvent> events =
      test::Stream(session.get(), dataset, test::ArrivalsOf(dataset, kLive, 1));
  ASSERT_EQ(Only<StartedEvent>(events).size(), 1u);
  EXPECT_EQ(Only<StartedEvent>(events)[0].method, "given");
  EXPECT_EQ(test::StatesOf(events).size(), dataset.frames.size());
}

// GIVEN a camera and an IMU that fail for two seconds, THEN the loss and the new start are reported in turn,
// and the states go on to the end.
TEST(SessionTest, ReportsLossAndRestart) {
  SimulatorConfig walk = Walk(22);
  walk.fault = SimFaultKind::kBlackoutAndImu;
  walk.fault_start_s = 8;
  walk.fault_duration_s = 2;
  const Dataset dataset = SimulateWalk(walk, 101);
  EstimatorConfig config;
  config.recovery.max_suspect_s = 1;
  const std::unique_ptr<Session> session = MakeSession(config, dataset);
  const std::vector<SessionEvent> events =
      test::Stream(session.get(), dataset, test::ArrivalsOf(dataset, kLive, 1));
  const auto lost = Only<LostEvent>(events);
  const auto restarted = Only<RestartedEvent>(events);
  ASSERT_FALSE(lost.empty());
  ASSERT_EQ(restarted.size(), lost.size());
  EXPECT_GT(lost[0].stamp_ns, dataset.imu.front().stamp_ns + SecondsToNs(8));
  EXPECT_FALSE(lost[0].reason.empty());
  for (const SkippedEvent& skipped : Only<SkippedEvent>(events)) {
    EXPECT_NE(skipped.sensor, Sensor::kImu) << skipped.reason;
  }
  EXPECT_EQ(restarted[0].lost_ns, lost[0].stamp_ns);
  EXPECT_GT(restarted[0].estimate.stamp_ns, lost[0].stamp_ns);
  for (const NavEstimate& state : test::StatesOf(events)) {
    EXPECT_FALSE(state.stamp_ns > lost[0].stamp_ns && state.stamp_ns < restarted[0].estimate.stamp_ns);
  }
  EXPECT_GT(test::StatesOf(events).back().stamp_ns, dataset.frames.back().stamp_ns - SecondsToNs(0.2));
  EXPECT_TRUE(session->running());
}

// GIVEN a session that runs, WHEN the newest state is asked for, THEN it is the last estimate propagated over
// the samples since, and asking changes nothing.
TEST(SessionTest, NewestIsTheLastEstimateCarriedOnOverTheImu) {
  const Dataset dataset = SimulateWalk(Walk(6), 1);
  const std::unique_ptr<Session> session = Started(dataset, 5.53);
  const NavEstimate last = test::StatesOf(session->TakeEvents()).back();
  const Result<NewestState> newest = session->Newest();
  ASSERT_TRUE(newest.ok()) << newest.message();
  EXPECT_GT(newest->estimate.stamp_ns, last.stamp_ns + SecondsToNs(0.05));

  NavEstimate by_hand = last;
  ImuBuffer buffer(1);
  for (const ImuSample& sample : dataset.imu) {
    ASSERT_TRUE(buffer.Add(sample).ok());
  }
  std::vector<ImuSample> interval;
  ASSERT_TRUE(buffer.Interval(last.stamp_ns, newest->estimate.stamp_ns, &interval).ok());
  ASSERT_TRUE(PropagateEstimate(interval, dataset.rig.imu_noise, GravityInWorld(9.81), &by_hand).ok());
  EXPECT_LT((newest->estimate.nav.p_WB - by_hand.nav.p_WB).norm(), 1e-12);
  EXPECT_LT((newest->estimate.covariance - by_hand.covariance).norm(), 1e-12);
  EXPECT_LT((newest->v_B - by_hand.nav.R_WB.transpose() * by_hand.nav.v_WB).norm(), 1e-12);
  EXPECT_LT((newest->omega_B - (interval.back().gyro - last.bias.gyro)).norm(), 1e-12);
  EXPECT_TRUE(test::SameBits(session->Newest()->estimate, newest->estimate));
}

TEST(SessionTest, NewestIsRefusedWithoutAnEstimate) {
  const Dataset dataset = SimulateWalk(Walk(1), 1);
  EXPECT_FALSE(MakeSession(EstimatorConfig(), dataset)->Newest().ok());
}

TEST(SessionTest, BadMessagesAreReportedAndDoNoHarm) {
  const Dataset dataset = SimulateWalk(Walk(6), 1);
  const std::unique_ptr<Session> session = Started(dataset, 5);
  (void)session->TakeEvents();
  const NavEstimate before = session->Newest()->estimate;
  ImuSample sample = dataset.imu.back();
  sample.gyro.x() = std::nan("");
  session->AddImu(sample);
  session->AddImu(dataset.imu[5]);    // long processed
  session->AddImu(dataset.imu[490]);  // again
  session->AddFrame(dataset.frames[3]);
  session->AddFrame({dataset.frames.back().stamp_ns + SecondsToNs(1e6), {}});  // no IMU reaches it
  TrackFrame nothing{dataset.frames[49].stamp_ns + 1, {{1, Eigen::Vector2d(NAN, INFINITY)}}};
  session->AddFrame(nothing);
  session->AddGnss(ObservationEpoch{before.stamp_ns, {}});
  const std::vector<SessionEvent> events = session->TakeEvents();
  const auto skipped = Only<SkippedEvent>(events);
  const auto late = Only<TooLateEvent>(events);
  ASSERT_GE(skipped.size(), 3u);
  EXPECT_EQ(skipped[0].sensor, Sensor::kImu);
  EXPECT_THAT(skipped[0].reason, HasSubstr("not finite"));
  EXPECT_THAT(skipped[1].reason, HasSubstr("already"));
  EXPECT_THAT(skipped.back().reason, HasSubstr("without GNSS"));
  ASSERT_EQ(late.size(), 2u);
  EXPECT_EQ(late[0].sensor, Sensor::kImu);
  EXPECT_EQ(late[0].stamp_ns, dataset.imu[5].stamp_ns);
  EXPECT_NEAR(late[0].late_s, 4.75, 0.06);
  EXPECT_EQ(late[1].sensor, Sensor::kCamera);
  EXPECT_THAT(Describe(SessionEvent(late[1])), HasSubstr("too late by"));
  EXPECT_TRUE(test::SameBits(session->Newest()->estimate, before));
  session->Flush();
  EXPECT_FALSE(Only<SkippedEvent>(session->TakeEvents()).empty()) << "the frame without IMU";
}

// GIVEN a camera that falls silent, THEN the estimate is given up after max_silence_s and what is held stays
// bounded.
TEST(SessionTest, SilenceEndsTheEstimateAndMemoryIsBounded) {
  const Dataset dataset = SimulateWalk(Walk(4), 1);
  SessionOptions options = GivenOptions(dataset);
  options.max_silence_s = 2;
  const std::unique_ptr<Session> session = MakeSession(GivenConfig(), dataset, options);
  for (const test::Arrival& message : test::ArrivalsOf(dataset, kLive, 1)) {
    test::AddTo(session.get(), dataset, message);
    (void)session->TakeEvents();
  }
  ASSERT_TRUE(session->running());
  std::vector<SessionEvent> events;
  ImuSample sample = dataset.imu.back();
  size_t most = 0;
  for (int i = 0; i < 20000; ++i) {
    sample.stamp_ns += 5'000'000;
    session->AddImu(sample);
    for (SessionEvent& event : session->TakeEvents()) {
      events.push_back(std::move(event));
    }
    most = std::max(most, session->held());
  }
  ASSERT_EQ(Only<LostEvent>(events).size(), 1u);
  EXPECT_THAT(Only<LostEvent>(events)[0].reason, HasSubstr("2 s"));
  EXPECT_LT(most, 1500u);  // 2 s of silence, the delays and the margin for a start
}

TEST(SessionTest, FramesThatNoImuReachesAreDroppedOldestFirst) {
  const Dataset dataset = SimulateWalk(Walk(2), 1);
  SessionOptions options = LiveOptions();
  options.max_waiting = 3;
  const std::unique_ptr<Session> session = MakeSession(EstimatorConfig(), dataset, options);
  for (size_t i = 0; i < 5; ++i) {
    session->AddFrame(dataset.frames[i]);
  }
  const auto skipped = Only<SkippedEvent>(session->TakeEvents());
  ASSERT_EQ(skipped.size(), 2u);
  EXPECT_EQ(skipped[0].stamp_ns, dataset.frames[0].stamp_ns);
  EXPECT_EQ(skipped[1].stamp_ns, dataset.frames[1].stamp_ns);
  EXPECT_EQ(session->held(), 3u);
}

// GIVEN one sample stamped an hour ahead, THEN it alone is skipped, and the estimate goes on as without it.
TEST(SessionTest, AStampFarAheadIsSkippedAlone) {
  const Dataset dataset = SimulateWalk(Walk(3), 1);
  const std::vector<test::Arrival> arrivals = test::ArrivalsOf(dataset, kLive, 1);
  const std::unique_ptr<Session> clean = MakeSession(GivenConfig(), dataset, GivenOptions(dataset));
  const std::vector<NavEstimate> expected = test::StatesOf(test::Stream(clean.get(), dataset, arrivals));
  const std::unique_ptr<Session> session = MakeSession(GivenConfig(), dataset, GivenOptions(dataset));
  std::vector<SessionEvent> events;
  for (size_t i = 0; i < arrivals.size(); ++i) {
    if (i == arrivals.size() / 2) {
      ImuSample wrong = dataset.imu.front();
      wrong.stamp_ns += SecondsToNs(3600);
      session->AddImu(wrong);
    }
    test::AddTo(session.get(), dataset, arrivals[i]);
    for (SessionEvent& event : session->TakeEvents()) {
      events.push_back(std::move(event));
    }
  }
  session->Flush();
  for (SessionEvent& event : session->TakeEvents()) {
    events.push_back(std::move(event));
  }
  const auto skipped = Only<SkippedEvent>(events);
  ASSERT_EQ(skipped.size(), 1u);
  EXPECT_THAT(skipped[0].reason, HasSubstr("after the previous sample"));
  EXPECT_TRUE(Only<TooLateEvent>(events).empty());
  const std::vector<NavEstimate> states = test::StatesOf(events);
  ASSERT_EQ(states.size(), expected.size());
  EXPECT_TRUE(test::SameBits(states.back(), expected.back()));
}

}  // namespace
}  // namespace alidade
