#include "eval/record/runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/error_convention.h"
#include "eval/record/run_options.h"
#include "eval/record/truth_start.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "tests/eval/record/fake_estimator.h"

namespace alidade {
namespace {

using test::FakeEstimator;
using test::RestingScene;
using testing::HasSubstr;

EstimatorConfig TruthConfig() {
  EstimatorConfig config;
  config.init.method = InitMethod::kTruth;
  config.init.perturb_truth = false;
  return config;
}

RunResult RunScene(const EstimatorConfig& config, const RestingScene& scene, FakeEstimator* estimator) {
  RunOptions options;
  options.truth = &scene.truth;
  return RunEstimator(config, scene.log, options, estimator);
}

TEST(Runner, RecordsEveryFrameFromTheFirstOn) {
  const RestingScene scene;
  FakeEstimator estimator;
  const RunResult result = RunScene(TruthConfig(), scene, &estimator);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_EQ(StatusWord(result), "ok");
  ASSERT_EQ(result.records.size(), scene.log.frames.size());
  EXPECT_EQ(result.init_method, "truth");
  EXPECT_EQ(result.init_stamp_ns, scene.log.frames[0].stamp_ns);
  for (size_t i = 0; i < result.records.size(); ++i) {
    EXPECT_EQ(result.records[i].estimate.stamp_ns, scene.log.frames[i].stamp_ns);
    EXPECT_EQ(result.records[i].statistics.tracks_in, static_cast<int>(i));
    EXPECT_EQ(result.records[i].frontend_ms, 1.5);
    EXPECT_NEAR((result.records[i].estimate.nav.p_WB - Eigen::Vector3d(1, 2, 3)).norm(), 0, 1e-9);
  }
  EXPECT_EQ(TrajectoryOf(result).points.size(), result.records.size());
}

TEST(Runner, DeliversImuUpToTheFirstSampleAtOrAfterTheFramesImuTime) {
  RestingScene scene(1.0, 0.004);
  scene.log.rig.camera_time_offset_s =
      0.003;  // IMU time 7 ms after a sample: the one 3 ms later must have come
  FakeEstimator estimator;
  estimator.time_offset_s = 0.003;
  const RunResult result = RunScene(TruthConfig(), scene, &estimator);
  ASSERT_EQ(estimator.imu_before_frame.size(), scene.log.frames.size());
  for (size_t i = 0; i + 1 < estimator.imu_before_frame.size(); ++i) {
    EXPECT_EQ(estimator.imu_before_frame[i], scene.log.frames[i].stamp_ns + 6'000'000) << i;
  }
  // No sample reaches the last frame: it is skipped, and said so.
  EXPECT_EQ(result.frames_skipped, 1);
  EXPECT_FALSE(result.skip_report.empty());
  EXPECT_EQ(result.records.size() + 1, scene.log.frames.size());
  EXPECT_EQ(result.imu_rejected, 0);
}

TEST(Runner, SampleOnTheFramesStampIsTheLastOneDelivered) {
  const RestingScene scene;
  FakeEstimator estimator;
  (void)RunScene(TruthConfig(), scene, &estimator);
  for (size_t i = 0; i < estimator.imu_before_frame.size(); ++i) {
    EXPECT_EQ(estimator.imu_before_frame[i], scene.log.frames[i].stamp_ns);
  }
}

// GIVEN an image that is the one before, THEN its frame has no observations and is marked, and no other is.
// GIVEN one repeated image and, later, a camera that is frozen for longer, THEN tracks go on across the
// frames up to a quarter of a second after the last new image.
TEST(Runner, RepeatedImagesAreMarkedForAQuarterOfASecond) {
  const auto frozen = [](size_t i) { return i == 2 || (i >= 4 && i < 9); };
  RestingScene scene;
  double shift_px = 0;
  for (size_t i = 0; i < scene.log.frames.size(); ++i) {  // 10 Hz
    shift_px = frozen(i) ? shift_px : static_cast<double>(i);
    scene.log.frames[i].observations.clear();
    for (int k = 0; k < 10; ++k) {
      scene.log.frames[i].observations.push_back({k, {10.0 * k + shift_px, 20}});
    }
  }
  FakeEstimator estimator;
  const RunResult result = RunScene(TruthConfig(), scene, &estimator);
  ASSERT_EQ(estimator.repeated.size(), scene.log.frames.size());
  for (size_t i = 0; i < scene.log.frames.size(); ++i) {
    EXPECT_EQ(estimator.repeated[i], i == 2 || i == 4 || i == 5) << i;
    EXPECT_EQ(result.records[i].statistics.tracks_in, frozen(i) ? 0 : 10) << i;
  }
}

TEST(Runner, WaitsForTruthThatStartsLater) {
  const RestingScene scene(1.0, 0.0, 0.25);
  FakeEstimator estimator;
  const RunResult result = RunScene(TruthConfig(), scene, &estimator);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_EQ(result.records.size(), 8u);
  EXPECT_EQ(result.init_stamp_ns, scene.log.frames[3].stamp_ns);
  // The sample before has its part in the curvature after the start.
  EXPECT_EQ(estimator.imu_stamps.front(), scene.log.frames[3].stamp_ns - 10'000'000);
}

TEST(Runner, KeepsWhatThereWasWhenTheEstimatorDiverges) {
  for (const bool not_finite : {false, true}) {
    const RestingScene scene;
    FakeEstimator estimator;
    (not_finite ? estimator.not_finite_at_frame : estimator.diverge_at_frame) = 5;
    const RunResult result = RunScene(TruthConfig(), scene, &estimator);
    EXPECT_EQ(result.status.code(), StatusCode::kDiverged);
    EXPECT_EQ(StatusWord(result), "diverged");
    EXPECT_EQ(result.records.size(), 4u);
    EXPECT_TRUE(result.records.back().estimate.nav.p_WB.allFinite());
  }
}

TEST(Runner, ReportsWhyTruthCannotStartTheRun) {
  RestingScene scene;
  FakeEstimator estimator;
  const RunResult without = RunEstimator(TruthConfig(), scene.log, RunOptions(), &estimator);
  EXPECT_EQ(without.status.code(), StatusCode::kInput);
  EXPECT_THAT(without.status.message(), HasSubstr("no ground truth"));
  EXPECT_EQ(StatusWord(without), "failed");
  scene.truth.has_bias = false;
  const RunResult poses_only = RunScene(TruthConfig(), scene, &estimator);
  EXPECT_EQ(poses_only.status.code(), StatusCode::kInput);
  EXPECT_THAT(poses_only.status.message(), HasSubstr("no bias columns"));
}

TEST(Runner, GivesUpAfterMaxWaitWithTheReason) {
  RestingScene scene(3.0, 0.0, 2.5);
  EstimatorConfig config = TruthConfig();
  config.init.max_wait_s = 1;
  FakeEstimator estimator;
  const RunResult result = RunScene(config, scene, &estimator);
  EXPECT_EQ(result.status.code(), StatusCode::kDiverged);
  EXPECT_EQ(StatusWord(result), "not_initialized");
  EXPECT_THAT(result.status.message(), HasSubstr("truth does not cover"));
  EXPECT_TRUE(result.records.empty());
}

TEST(Runner, StopsWhenAsked) {
  const RestingScene scene;
  FakeEstimator estimator;
  std::atomic<bool> stop{false};
  RunOptions options;
  options.truth = &scene.truth;
  options.stop = &stop;
  options.progress = [&stop](size_t done, size_t) { stop = done == 3; };
  const RunResult result = RunEstimator(TruthConfig(), scene.log, options, &estimator);
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(StatusWord(result), "interrupted");
  EXPECT_EQ(result.records.size(), 3u);
}

// GIVEN an estimator that looks back, WHEN the log ends, THEN its revised frames replace those recorded.
TEST(Runner, TakesTheRevisedEstimatesAtTheEnd) {
  const RestingScene scene(0.2);
  FakeEstimator estimator;
  for (const TrackFrame& frame : scene.log.frames) {
    FinalizedFrame revised;
    revised.estimate.stamp_ns = frame.stamp_ns;
    revised.estimate.nav.p_WB = {7, 8, 9};
    revised.statistics.iterations = 3;
    revised.filtering_covariance = 2 * Matrix15d::Identity();
    estimator.finalized.push_back(revised);
  }
  const RunResult result = RunScene(TruthConfig(), scene, &estimator);
  ASSERT_TRUE(result.status.ok()) << result.status.message();
  EXPECT_EQ(estimator.finalized_calls, 1);
  ASSERT_EQ(result.records.size(), scene.log.frames.size());
  for (const RunRecord& record : result.records) {
    EXPECT_EQ(record.estimate.nav.p_WB, Eigen::Vector3d(7, 8, 9));
    EXPECT_EQ(record.statistics.iterations, 3);
    EXPECT_EQ(record.frontend_ms, 1.5);
    ASSERT_TRUE(record.filtering_covariance.has_value());
    EXPECT_EQ(*record.filtering_covariance, Matrix6d(2 * Matrix6d::Identity()));
  }
}

TEST(Runner, KeepsTheRecordsWhenThereIsNoRevision) {
  const RestingScene scene(0.2);
  FakeEstimator estimator;
  estimator.finalized_status = Status::Diverged("fake: far from the minimum");
  const RunResult result = RunScene(TruthConfig(), scene, &estimator);
  EXPECT_EQ(StatusWord(result), "diverged");
  EXPECT_THAT(result.status.message(), HasSubstr("far from the minimum"));
  EXPECT_EQ(result.records.size(), scene.log.frames.size());

  FakeEstimator lost;
  lost.diverge_at_frame = 2;
  EXPECT_FALSE(RunScene(TruthConfig(), scene, &lost).status.ok());
  EXPECT_EQ(lost.finalized_calls, 0);
}

TEST(Runner, EveryBackendHasAName) {
  EXPECT_EQ(ToString(Backend::kFilter), "filter");
  EXPECT_EQ(ToString(Backend::kSmoother), "smoother");
  EXPECT_EQ(ToString(Backend::kBatch), "batch");
}

TEST(TruthStart, DrawnErrorFitsItsCovariance) {
  const RestingScene scene;
  InitConfig config;
  config.tilt_std_rad = 0.05;
  config.yaw_std_rad = 0.002;
  const TimeNs stamp = scene.truth.points[5].stamp_ns + 3'000'000;
  const TrajectoryPoint truth = *InterpolateTruth(scene.truth, stamp);
  constexpr int kDraws = 400;
  double nees = 0;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const Result<NavEstimate> start = StartFromTruth(config, scene.truth, stamp, seed);
    ASSERT_TRUE(start.ok());
    Vector15d error;
    error << Local(ErrorConvention::kSo3xRn, start->nav, truth.nav), truth.bias.gyro - start->bias.gyro,
        truth.bias.accel - start->bias.accel;
    nees += error.dot(start->covariance.inverse() * error) / kDraws;
  }
  // Mean of 400 chi-square values of 15 degrees of freedom: standard deviation sqrt(30 / 400) = 0.27.
  EXPECT_NEAR(nees, 15, 4 * 0.27);
}

TEST(TruthStart, EqualSeedsDrawEqualStarts) {
  const RestingScene scene;
  const TimeNs stamp = scene.truth.points[5].stamp_ns;
  const NavEstimate a = *StartFromTruth(InitConfig(), scene.truth, stamp, 3);
  const NavEstimate b = *StartFromTruth(InitConfig(), scene.truth, stamp, 3);
  const NavEstimate c = *StartFromTruth(InitConfig(), scene.truth, stamp, 4);
  EXPECT_EQ(a.nav.R_WB, b.nav.R_WB);
  EXPECT_EQ(a.bias.accel, b.bias.accel);
  EXPECT_NE(a.nav.p_WB, c.nav.p_WB);
}

TEST(TruthStart, TheDigestIsOfWhatAStartTakesAndOfNothingElse) {
  const RestingScene scene;
  const InitConfig config = TruthConfig().init;
  const std::string digest = DigestOfStartTruth(config, &scene.truth);
  EXPECT_EQ(digest.size(), 64u);
  Trajectory other = scene.truth;
  EXPECT_EQ(DigestOfStartTruth(config, &other), digest);
  other.points[3].covariance.setIdentity();
  EXPECT_EQ(DigestOfStartTruth(config, &other), digest);
  other.points[3].bias.gyro.x() += 1e-9;
  EXPECT_NE(DigestOfStartTruth(config, &other), digest);
  other = scene.truth;
  other.points.pop_back();
  EXPECT_NE(DigestOfStartTruth(config, &other), digest);
  EXPECT_EQ(DigestOfStartTruth(config, nullptr), "");
  InitConfig another = config;
  another.method = InitMethod::kStatic;
  EXPECT_EQ(DigestOfStartTruth(another, &scene.truth), "");
}

TEST(TruthStart, NeverInterpolatesOverAGap) {
  RestingScene scene;
  scene.truth.points.erase(scene.truth.points.begin() + 20, scene.truth.points.begin() + 40);
  const TimeNs inside = scene.truth.points[19].stamp_ns + 50'000'000;
  EXPECT_THAT(InterpolateTruth(scene.truth, inside).message(), HasSubstr("gap"));
  EXPECT_TRUE(InterpolateTruth(scene.truth, scene.truth.points[19].stamp_ns).ok());
  EXPECT_FALSE(InterpolateTruth(scene.truth, scene.truth.points.back().stamp_ns + 1).ok());
  EXPECT_FALSE(InterpolateTruth(Trajectory(), 0).ok());
}

TEST(EstimatorTest, GIVEN_a_back_end_without_a_sensor_WHEN_it_is_handed_a_measurement_THEN_it_names_the_key) {
  FakeEstimator estimator;
  const Status status = estimator.AddMeasurement(PositionFix());
  EXPECT_EQ(status.code(), StatusCode::kConfig);
  EXPECT_EQ(status.message(), "fix.enabled: this back end takes no position fixes; expected false");
}

}  // namespace
}  // namespace alidade
