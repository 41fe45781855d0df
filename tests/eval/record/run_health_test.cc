#include "eval/record/run_health.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "eval/files/input_file.h"
#include "eval/record/recorder.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "tests/eval/record/fake_estimator.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class RunHealthTest : public testing::Test {
 protected:
  RunHealthTest() { config_.init.method = InitMethod::kTruth; }

  RunResult Run() {
    test::FakeEstimator estimator;
    RunOptions options;
    options.truth = &scene_.truth;
    return RunEstimator(config_, scene_.log, options, &estimator);
  }
  /// A sound run of which `count` states after the first are called `status`, of this kind.
  RunResult RunWith(size_t count, const char* status, DegradationKind kind = DegradationKind::kData) {
    RunResult result = Run();
    for (size_t i = 1; i <= count; ++i) {
      result.records.at(i).status = status;
      result.records.at(i).degradation = kind;
    }
    return result;
  }
  /// The largest number of frames of `all` that may be without a sound state.
  static size_t Tolerated(size_t all) {
    return static_cast<size_t>(std::floor(kMaxImpairedShare * static_cast<double>(all)));
  }

  const test::RestingScene scene_{5.0};
  EstimatorConfig config_;
};

TEST_F(RunHealthTest, GivenASoundRunThenNothingIsReported) {
  const RunResult result = Run();
  const RunHealth health = HealthOf(config_, result);
  EXPECT_THAT(health.impairments, IsEmpty());
  EXPECT_EQ(health.states.at("ok"), result.records.size());
  EXPECT_EQ(health.states.at("degraded"), 0u);
  EXPECT_EQ(health.unsound_s, 0);
  EXPECT_THAT(DescribeRun(health, result), StartsWith("ok: "));
  EXPECT_THAT(DescribeRun(health, result), Not(HasSubstr("degraded")));
}

TEST_F(RunHealthTest, GivenAShortFaultThenItsStatesAndSecondsAreReportedAndTheRunIsOk) {
  const size_t few = Tolerated(Run().records.size());
  ASSERT_GE(few, 1u);
  const RunResult result = RunWith(few, "degraded");
  const RunHealth health = HealthOf(config_, result);
  EXPECT_THAT(health.impairments, IsEmpty());
  EXPECT_NEAR(health.unsound_s, 0.1 * static_cast<double>(few), 1e-9);
  EXPECT_THAT(DescribeRun(health, result), StartsWith("ok: "));
  EXPECT_THAT(DescribeRun(health, result),
              HasSubstr(", " + std::to_string(few) + " degraded (0." + std::to_string(few) + "0 s)"));
}

TEST_F(RunHealthTest, GivenMoreThanTheToleratedShareThenTheRunIsImpaired) {
  const size_t many = Tolerated(Run().records.size()) + 1;
  for (const char* status : {"degraded", "suspect", "lost"}) {
    const RunResult result = RunWith(many, status);
    const RunHealth health = HealthOf(config_, result);
    ASSERT_EQ(health.impairments.size(), 1u) << status;
    EXPECT_THAT(health.impairments[0], StartsWith(std::to_string(many) + " of "));
    EXPECT_THAT(DescribeRun(health, result), StartsWith("impaired: "));
    EXPECT_THAT(DescribeRun(health, result), HasSubstr(", " + std::to_string(many) + " " + status));
  }
  EXPECT_THAT(HealthOf(config_, RunWith(many, "local")).impairments, IsEmpty());
}

// GIVEN a model that is doubted in up to half of the run THEN it is reported and the run is ok; in more it is
// not.
TEST_F(RunHealthTest, GivenADoubtedModelThenHalfOfTheRunIsTolerated) {
  const size_t half = Run().records.size() / 2;
  ASSERT_GT(half, 2 * Tolerated(2 * half));
  RunResult result = RunWith(half, "degraded", DegradationKind::kModel);
  EXPECT_THAT(HealthOf(config_, result).impairments, IsEmpty());
  EXPECT_EQ(HealthOf(config_, result).states.at("degraded"), half);
  EXPECT_THAT(DescribeRun(HealthOf(config_, result), result), StartsWith("ok: "));

  // Missing data have a limit of their own.
  const size_t few = Tolerated(result.records.size());
  for (size_t i = half + 1; i <= half + few; ++i) {
    result.records.at(i).status = "degraded";
  }
  EXPECT_THAT(HealthOf(config_, result).impairments, IsEmpty());
  result.records.at(half + few + 1).status = "degraded";
  EXPECT_THAT(HealthOf(config_, result).impairments, ElementsAre(HasSubstr("without a sound state")));

  result = RunWith(half + 1, "degraded", DegradationKind::kModel);
  EXPECT_THAT(HealthOf(config_, result).impairments,
              ElementsAre(testing::AllOf(StartsWith(std::to_string(half + 1) + " of "),
                                         HasSubstr("whose model is in doubt, expected at most 50 %"))));
}

// The kind is that of a degraded state, whatever else became of the record.
TEST_F(RunHealthTest, GivenStatesThatAreLostOrSuspectThenTheirModelDoesNotExcuseThem) {
  const size_t many = Tolerated(Run().records.size()) + 1;
  for (const char* status : {"suspect", "lost"}) {
    EXPECT_THAT(HealthOf(config_, RunWith(many, status, DegradationKind::kModel)).impairments,
                ElementsAre(HasSubstr("without a sound state")));
  }
}

// GIVEN an IMU that ends before the images THEN the frames without it are counted, and the reason is
// reported.
TEST_F(RunHealthTest, GivenFramesBeyondTheImuThenTheRunIsImpairedWithAReason) {
  test::RestingScene scene;
  scene.log.imu.resize(scene.log.imu.size() / 2);
  test::FakeEstimator estimator;
  RunOptions options;
  options.truth = &scene.truth;
  const RunResult result = RunEstimator(config_, scene.log, options, &estimator);
  ASSERT_GT(result.frames_skipped, 0);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  const RunHealth health = HealthOf(config_, result);
  EXPECT_EQ(health.impairments.size(), 1u);
  EXPECT_THAT(DescribeRun(health, result), StartsWith("impaired: "));
  EXPECT_THAT(DescribeRun(health, result),
              HasSubstr(std::to_string(result.frames_skipped) + " skipped (no imu sample reaches "));
}

TEST_F(RunHealthTest, GivenSensorsThatTheSequenceLacksThenEachIsNamed) {
  config_.gnss.enabled = config_.fix.enabled = true;
  RunResult result = Run();
  EXPECT_THAT(MissingSensors(config_, scene_.log), ElementsAre("GNSS", "position fixes"));
  EXPECT_THAT(HealthOf(config_, result).impairments,
              ElementsAre("GNSS was not used: the sequence has no GNSS",
                          "position fixes were not used: the sequence has no position fixes"));
  // Fixes aligned the run: GNSS is missing nonetheless.
  result.missing_sensors = {"GNSS"};
  result.global.emplace();
  EXPECT_THAT(HealthOf(config_, result).impairments,
              ElementsAre("GNSS was not used: the sequence has no GNSS"));
  result.missing_sensors.clear();
  EXPECT_THAT(HealthOf(config_, result).impairments, IsEmpty());
}

TEST_F(RunHealthTest, GivenAnImpairedRunThenRunJsonHoldsIt) {
  const RunResult result = RunWith(Tolerated(Run().records.size()) + 1, "degraded");
  const test::TemporaryFolder folder;
  ASSERT_TRUE(WriteRun({config_, "name", "dd", "ii", 1, 2, 3, false}, result, folder.path()).ok());
  const auto json = nlohmann::json::parse(*ReadWholeFile(folder.File("run.json")));
  EXPECT_EQ(json["status"], "ok");
  EXPECT_EQ(json["states"]["degraded"], Tolerated(result.records.size()) + 1);
  EXPECT_EQ(json["states"]["lost"], 0);
  EXPECT_GT(json["unsound_s"], 0);
  ASSERT_EQ(json["impaired"].size(), 1u);
  EXPECT_THAT(json["impaired"][0].get<std::string>(), HasSubstr("without a sound state"));
}

}  // namespace
}  // namespace alidade
