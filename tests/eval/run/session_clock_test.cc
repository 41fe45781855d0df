#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "eval/record/runner.h"
#include "eval/record/truth_start.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/eval/run/stream.h"

// Silences of the IMU that are jumps of its clock, and such that are not.

namespace alidade {
namespace {

using test::Only;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kFaultS = 4;

class SessionClockTest : public testing::Test {
 protected:
  SessionClockTest() {
    SimulatorConfig config;
    config.duration_s = 9;
    config.path_m = 12;
    config.wobble_rad = 0.15;
    Result<Dataset> dataset = Simulate(config, 3);
    EXPECT_TRUE(dataset.ok()) << dataset.message();
    clean_ = std::move(*dataset);
    config_.init.method = InitMethod::kTruth;
  }

  [[nodiscard]] TimeNs At(double seconds) const { return clean_.imu.front().stamp_ns + SecondsToNs(seconds); }
  /// The walk with an IMU whose clock jumps.
  [[nodiscard]] Dataset Jumped(double jump_s) const {
    Dataset dataset = clean_;
    for (ImuSample& sample : dataset.imu) {
      sample.stamp_ns += sample.stamp_ns >= At(kFaultS) ? SecondsToNs(jump_s) : 0;
    }
    return dataset;
  }
  /// With an IMU that loses samples from `begin_s` on.
  [[nodiscard]] Dataset Silent(double begin_s, double duration_s) const {
    Dataset dataset = clean_;
    std::erase_if(dataset.imu, [&](const ImuSample& sample) {
      return sample.stamp_ns >= At(begin_s) && sample.stamp_ns < At(begin_s + duration_s);
    });
    return dataset;
  }
  [[nodiscard]] RunResult Run(const Dataset& dataset) const {
    return RunEstimator(config_, {dataset.rig, dataset.imu, dataset.frames}, &*dataset.truth, 1);
  }
  /// Of a live session in which the messages arrive when those of the clean walk do.
  [[nodiscard]] std::vector<SessionEvent> Live(const Dataset& dataset) const {
    SessionOptions options;
    options.lateness = {0.01, 0.1, 0};
    options.start_state = [this](TimeNs imu_ns) {
      return StartFromTruth(config_.init, *clean_.truth, imu_ns, 1);
    };
    Result<std::unique_ptr<Session>> session = Session::Make(config_, dataset.rig, options);
    EXPECT_TRUE(session.ok()) << session.message();
    return test::Stream(session->get(), dataset, test::ArrivalsOf(clean_, {{0.02, 0.008}, {0.06, 0}, {}}, 1));
  }
  static std::vector<std::string> Reasons(const std::vector<SessionEvent>& events) {
    std::vector<std::string> reasons;
    for (const DegradedEvent& event : Only<DegradedEvent>(events)) {
      reasons.push_back(event.reason);
    }
    return reasons;
  }

  Dataset clean_;
  EstimatorConfig config_;
};

// GIVEN a clock of the IMU that jumps, THEN the states of a log are those without the jump, bit by bit.
TEST_F(SessionClockTest, AJumpInALogIsTakenOffTheStamps) {
  const RunResult expected = Run(clean_);
  ASSERT_TRUE(expected.status.ok()) << expected.status.message();
  for (const double jump_s : {0.2, 1.5}) {
    const RunResult run = Run(Jumped(jump_s));
    ASSERT_TRUE(run.status.ok()) << run.status.message();
    ASSERT_EQ(run.records.size(), expected.records.size());
    size_t degraded = 0;
    for (size_t i = 0; i < run.records.size(); ++i) {
      ASSERT_TRUE(test::SameBits(run.records[i].estimate, expected.records[i].estimate)) << i;
      degraded += run.records[i].status == "degraded" ? 1 : 0;
    }
    EXPECT_EQ(degraded, 5u);  // for 0.5 s
  }
}

// GIVEN the same in a live session, THEN likewise, and the reason names clock and jump.
TEST_F(SessionClockTest, AJumpInALiveSessionIsTakenOffTheStamps) {
  const std::vector<NavEstimate> expected = test::StatesOf(Live(clean_));
  const std::vector<SessionEvent> events = Live(Jumped(0.5));
  EXPECT_THAT(Only<TooLateEvent>(events), IsEmpty());
  EXPECT_THAT(Only<SkippedEvent>(events), IsEmpty());
  const std::vector<NavEstimate> states = test::StatesOf(events);
  ASSERT_EQ(states.size(), expected.size());
  for (size_t i = 0; i < states.size(); ++i) {
    ASSERT_TRUE(test::SameBits(states[i], expected[i])) << i;
  }
  const std::vector<std::string> reasons = Reasons(events);
  ASSERT_THAT(reasons, Not(IsEmpty()));
  EXPECT_THAT(reasons, Each(HasSubstr("the IMU's clock jumped by 0.500 s")));
}

// GIVEN an IMU that loses samples, THEN it was silent, and later samples keep their stamps.
TEST_F(SessionClockTest, ALossOfSamplesIsNoJump) {
  for (const double begin_s : {3.0, 4.0, 5.0}) {
    const Dataset dataset = Silent(begin_s, 0.4);
    SessionOptions options;
    options.live = false;
    options.start_state = [this](TimeNs imu_ns) {
      return StartFromTruth(config_.init, *clean_.truth, imu_ns, 1);
    };
    Result<std::unique_ptr<Session>> session = Session::Make(config_, dataset.rig, options);
    ASSERT_TRUE(session.ok()) << session.message();
    const std::vector<SessionEvent> events =
        test::Stream(session->get(), dataset, test::ArrivalsOf(dataset, {}, 1));
    EXPECT_EQ((*session)->imu_jump_ns(), 0);
    EXPECT_THAT(Reasons(events), Not(IsEmpty()));
    EXPECT_THAT(Reasons(events), Each(HasSubstr("the IMU was silent for 0.41 s")));
  }
}

// GIVEN a silence 0.4 s before the log ends, about which no frame decides, THEN every frame is processed.
TEST_F(SessionClockTest, FramesThatWaitAtTheEndOfALogAreProcessed) {
  Dataset dataset = Silent(8.3, 0.3);
  for (TrackFrame& frame : dataset.frames) {
    if (frame.stamp_ns >= At(8.3)) {
      frame.observations.clear();
    }
  }
  const RunResult run = Run(dataset);
  ASSERT_TRUE(run.status.ok()) << run.status.message();
  EXPECT_EQ(run.records.size(), dataset.frames.size());
}

// GIVEN a silence about which no frame decides in a live session, THEN frames wait for no longer than a
// second and the length of the silence after its end.
TEST_F(SessionClockTest, FramesWaitNoLongerThanTheDoubt) {
  Dataset dataset = Silent(kFaultS, 0.3);
  for (TrackFrame& frame : dataset.frames) {
    if (frame.stamp_ns >= At(kFaultS)) {
      frame.observations.clear();
    }
  }
  SessionOptions options;
  options.start_state = [this](TimeNs imu_ns) {
    return StartFromTruth(config_.init, *clean_.truth, imu_ns, 1);
  };
  Result<std::unique_ptr<Session>> session = Session::Make(config_, dataset.rig, options);
  ASSERT_TRUE(session.ok()) << session.message();
  TimeNs longest_ns = 0;
  for (const test::Arrival& message : test::ArrivalsOf(dataset, {}, 1)) {
    test::AddTo(session->get(), dataset, message);
    for (const NavEstimate& state : test::StatesOf((*session)->TakeEvents())) {
      longest_ns = std::max(longest_ns, message.arrival_ns - state.stamp_ns);
    }
  }
  EXPECT_EQ((*session)->imu_jump_ns(), 0);
  // The first of them may lie at the beginning of the silence.
  EXPECT_LT(longest_ns, SecondsToNs(ImuClock::kDoubtS + 2 * 0.3 + 0.15));
  EXPECT_GT(longest_ns, SecondsToNs(ImuClock::kDoubtS));
}

}  // namespace
}  // namespace alidade
