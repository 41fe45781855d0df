#include <gtest/gtest.h>

#include <cmath>

#include "eval/config/config_yaml.h"
#include "eval/record/runner.h"
#include "eval/record/truth_start.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/eval/run/stream.h"

// Sessions with position fixes.

namespace alidade {
namespace {

using test::Only;

constexpr test::Delays kLive = {{0.02, 0.008}, {0.06, 0.1}, {0.2, 0.1}, {0.1, 0.2}};

Dataset SimulateFixes(const std::string& name, const std::vector<std::string>& settings) {
  const Result<SimulatorConfig> config =
      LoadSimulatorConfig(std::string(ALIDADE_SOURCE_DIR) + "/configs/datasets/" + name + ".yaml", settings);
  EXPECT_TRUE(config.ok()) << config.message();
  Result<Dataset> dataset = Simulate(*config, 1);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return *dataset;
}

const Dataset& Walk() {
  static const Dataset* const dataset = new Dataset(
      SimulateFixes("fix_figure8", {"duration_s=14", "path_m=56", "landmark_count=1500", "fix.rate_hz=4",
                                    "fix.std_m=0.1", "fix.time_offset_s=0.031"}));
  return *dataset;
}

EstimatorConfig Preset(const std::string& name, const std::string& gnss) {
  const Result<EstimatorConfig> config = LoadEstimatorConfig(
      std::string(ALIDADE_SOURCE_DIR) + "/configs/estimators/" + name + ".yaml",
      {"gnss.enabled=" + gnss, "fix.enabled=true", "gnss.model_std_scale=0", "init.method=truth"});
  EXPECT_TRUE(config.ok()) << config.message();
  return *config;
}

SessionOptions Options(const EstimatorConfig& config, const Dataset& dataset) {
  SessionOptions options;
  options.lateness = {0.01, 0.2, 0.4, 0.4};
  if (dataset.gnss != nullptr) {
    options.gnss = SetupOf(*dataset.gnss);
  }
  options.start_state = [init = config.init, &dataset](TimeNs imu_ns) {
    return StartFromTruth(init, *dataset.truth, imu_ns, 1);
  };
  return options;
}

RunResult RunOrdered(const EstimatorConfig& config, const Dataset& dataset) {
  return RunEstimator(config, {dataset.rig, dataset.imu, dataset.frames, {}, dataset.gnss, dataset.fixes},
                      &*dataset.truth, 1);
}

std::vector<SessionEvent> StreamOf(const EstimatorConfig& config, const Dataset& dataset, unsigned seed) {
  Result<std::unique_ptr<Session>> session = Session::Make(config, dataset.rig, Options(config, dataset));
  EXPECT_TRUE(session.ok()) << session.message();
  return test::Stream(session->get(), dataset, test::ArrivalsOf(dataset, kLive, seed));
}

class SessionFixTest : public testing::TestWithParam<const char*> {};

TEST_P(SessionFixTest, GIVEN_fixes_that_come_late_THEN_the_session_aligns_and_gives_the_states_of_the_log) {
  const Dataset& dataset = Walk();
  const EstimatorConfig config = Preset(GetParam(), "false");
  const RunResult ordered = RunOrdered(config, dataset);
  ASSERT_TRUE(ordered.status.ok()) << ordered.status.message();
  ASSERT_TRUE(ordered.global.has_value()) << ordered.align_report;
  EXPECT_EQ(ordered.skipped[SensorOf<PositionFixEntry>()], 0) << ordered.skip_report;
  const std::vector<SessionEvent> events = StreamOf(config, dataset, 1);
  EXPECT_TRUE(Only<TooLateEvent>(events).empty());
  const auto aligned = Only<AlignedEvent>(events);
  ASSERT_EQ(aligned.size(), 1u);
  EXPECT_EQ(aligned[0].global.source, SensorOf<PositionFixEntry>());
  EXPECT_TRUE(aligned[0].global.enu.has_value());
  EXPECT_FALSE(aligned[0].clock.has_value());
  EXPECT_EQ(aligned[0].global.yaw_rad, ordered.global->yaw_rad);
  EXPECT_LT(std::abs(aligned[0].global.yaw_rad), 5 * aligned[0].global.yaw_std_rad);
  test::ExpectStatesOfLog(ordered.records, aligned[0], test::StatesOf(events));
  EXPECT_GT(test::StatesOf(events, SensorOf<PositionFixEntry>()).size(), 10u);
  int used = 0;
  for (const RunRecord& record : ordered.records) {
    used += record.statistics.sensors[SensorOf<PositionFixEntry>()].used;
  }
  EXPECT_GT(used, 10);
}

TEST_P(SessionFixTest, GIVEN_raw_GNSS_and_fixes_THEN_there_is_one_alignment_and_both_are_used) {
  const Dataset dataset =
      SimulateFixes("gnss_figure8_short", {"duration_s=12", "path_m=48", "fix.rate_hz=2"});
  const RunResult run = RunOrdered(Preset(GetParam(), "true"), dataset);
  ASSERT_TRUE(run.status.ok()) << run.status.message();
  ASSERT_TRUE(run.global.has_value()) << run.align_report;
  EXPECT_EQ(run.global->source, Sensor::kGnss);
  int fixes = 0;
  int satellites = 0;
  for (const RunRecord& record : run.records) {
    fixes += record.statistics.sensors[SensorOf<PositionFixEntry>()].used;
    satellites += record.statistics.satellites_used;
  }
  EXPECT_GT(fixes, 5);
  EXPECT_GT(satellites, 100);
  EXPECT_EQ(run.skipped[SensorOf<PositionFixEntry>()], 0) << run.skip_report;
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, SessionFixTest, testing::Values("gvio", "gvins_class"),
                         [](const auto& param) { return std::string(param.param); });

TEST(SessionWithoutFixesTest, GIVEN_what_the_session_cannot_use_THEN_it_says_why) {
  const Dataset& dataset = Walk();
  EstimatorConfig config = Preset("gvio", "false");
  const PositionFix& fix = dataset.fixes.front();
  config.fix.enabled = false;
  Result<std::unique_ptr<Session>> without = Session::Make(config, dataset.rig, Options(config, dataset));
  ASSERT_TRUE(without.ok());
  (*without)->AddFix(fix);
  config.fix.enabled = true;
  Result<std::unique_ptr<Session>> session = Session::Make(config, dataset.rig, Options(config, dataset));
  ASSERT_TRUE(session.ok());
  PositionFix of_another = fix;
  of_another.sensor = 3;
  (*session)->AddFix(fix);
  (*session)->AddFix(fix);
  (*session)->AddFix(of_another);
  (*session)->AdvanceTo(fix.stamp_ns + 1'000'000'000);
  (*session)->AddFix(fix);
  EXPECT_EQ(Only<SkippedEvent>((*without)->TakeEvents()).size(), 1u);
  const std::vector<SessionEvent> events = (*session)->TakeEvents();
  const auto skipped = Only<SkippedEvent>(events);
  ASSERT_EQ(skipped.size(), 2u);
  EXPECT_EQ(skipped[0].sensor, SensorOf<PositionFixEntry>());
  EXPECT_NE(Describe(skipped[1]).find("no fix sensor 3"), std::string::npos) << Describe(skipped[1]);
  ASSERT_EQ(Only<TooLateEvent>(events).size(), 1u);
  EXPECT_EQ(Only<TooLateEvent>(events)[0].sensor, SensorOf<PositionFixEntry>());
}

}  // namespace
}  // namespace alidade
