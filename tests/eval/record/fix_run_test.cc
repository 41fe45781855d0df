#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <filesystem>

#include "core/yaw_shift.h"
#include "eval/record/recorder.h"
#include "eval/record/recorder_reader.h"
#include "tests/support/scenario.h"

// Runs with position fixes.

namespace alidade::test {
namespace {

using Eigen::Vector3d;

/// What became of one run.
struct FixScore {
  double aligned_s = -1;  ///< since the start of the motion
  int gated = 0;
  double nees_position = 0;  ///< mean over the frames after the alignment, 3 is ideal
  double rmse_m = 0;
  double nis = 0;
  int nis_dof = 0;
};

/// Figure-8 of 500 m in 120 s (4 m/s) with position fixes, a tenth of them wrong, and an outage of 30 s. Two
/// seeds here; scripts/fix_acceptance.sh runs twelve.
SimulatorConfig Scene(double std_m) {
  SimulatorConfig config;
  config.duration_s = 120;
  config.length_m = 180;
  config.width_m = 90;
  config.height_m = 3;
  config.path_m = 500;
  config.landmark_count = 2000;
  config.landmark_max_distance_m = 20;
  config.max_features = 40;
  config.fix.rate_hz = 1;
  config.fix.std_m = std_m;
  config.fix.time_offset_s = 0.037;
  config.fix.wrong_rate = 0.1;
  config.fix.outage_start_s = 60;
  return config;
}

EstimatorConfig Preset(Backend backend) {
  EstimatorConfig config;
  config.backend = backend;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.window = 12;
  config.filter.clone_policy = ClonePolicy::kOldest;
  config.filter.track_memory = TrackMemoryPolicy::kWindow;
  config.init.method = InitMethod::kTruth;
  config.fix.enabled = true;
  return config;
}

/// The run starts in a local world that is turned by `yaw_rad` and shifted against that of the fixes.
RunResult RunWithFixes(const EstimatorConfig& config, const Dataset& dataset, unsigned seed, double yaw_rad) {
  RunOptions options;
  options.seed = seed;
  options.start_state = [&](TimeNs /*imu_ns*/) {
    NavEstimate start = DrawInitialState(dataset, seed);
    start.nav = YawShift{yaw_rad, Vector3d(7, -3, 2)} * start.nav;
    return Result<NavEstimate>(start);
  };
  return RunEstimator(config, {dataset.rig, dataset.imu, dataset.frames, {}, nullptr, dataset.fixes},
                      options);
}

FixScore Score(const RunResult& run, const Dataset& dataset) {
  FixScore score;
  if (!run.global) {
    return score;
  }
  score.aligned_s = SecondsBetween(dataset.frames.front().stamp_ns, run.global->stamp_ns);
  int frames = 0;
  for (const RunRecord& record : run.records) {
    const NavEstimate& now = record.estimate;
    if (now.stamp_ns < run.global->stamp_ns) {
      continue;
    }
    const Vector3d error = now.nav.p_WB - TruthAt(dataset, now.stamp_ns).nav.p_WB;
    score.nees_position += error.dot(now.covariance.block<3, 3>(3, 3).ldlt().solve(error));
    score.rmse_m += error.squaredNorm();
    const SensorStatistics& counts = record.statistics.sensors[SensorOf<PositionFixEntry>()];
    score.gated += counts.gated;
    score.nis += counts.nis;
    score.nis_dof += counts.nis_dof;
    ++frames;
  }
  score.nees_position /= std::max(frames, 1);
  score.rmse_m = std::sqrt(score.rmse_m / std::max(frames, 1));
  return score;
}

/// Mean over `runs` runs with seeds from `first_seed` on.
void ExpectConsistent(Backend backend, double std_m, unsigned first_seed, int runs, double max_rmse_m) {
  double nees = 0;
  double nis = 0;
  int nis_dof = 0;
  for (unsigned seed = first_seed; seed < first_seed + static_cast<unsigned>(runs); ++seed) {
    const Dataset dataset = SimulateOrDie(Scene(std_m), seed);
    const RunResult run = RunWithFixes(Preset(backend), dataset, seed, 0.7 * seed);
    ASSERT_TRUE(run.status.ok()) << run.status.message();
    EXPECT_EQ(run.skipped[SensorOf<PositionFixEntry>()], 0) << run.skip_report;
    const FixScore score = Score(run, dataset);
    EXPECT_GE(score.aligned_s, 0) << "seed " << seed << ": " << run.align_report;
    EXPECT_LT(score.aligned_s, 15) << "seed " << seed;
    EXPECT_GE(score.gated, 3) << "seed " << seed;
    EXPECT_LT(score.rmse_m, max_rmse_m) << "seed " << seed;
    nees += score.nees_position / runs;
    nis += score.nis;
    nis_dof += score.nis_dof;
  }
  // Coarse, for the errors of two runs are hardly more than two independent ones. scripts/fix_acceptance.sh
  // compares twelve seeds with their band of chi-square.
  EXPECT_NEAR(nees, 3, 2.2);
  EXPECT_NEAR(nis / nis_dof, 1, 0.25);
}

class FixRunTest : public testing::TestWithParam<Backend> {};

TEST_P(FixRunTest, GIVEN_fixes_of_a_metre_an_outage_and_wrong_ones_THEN_it_aligns_and_is_consistent) {
  ExpectConsistent(GetParam(), 1, 11, 2, 1.5);
}

TEST_P(FixRunTest, GIVEN_fixes_of_2_cm_an_outage_and_wrong_ones_THEN_it_aligns_and_is_consistent) {
  ExpectConsistent(GetParam(), 0.02, 21, 2, 0.5);
}

TEST_P(FixRunTest, WHEN_a_run_with_fixes_is_written_THEN_it_reads_back_with_what_became_of_them) {
  SimulatorConfig scene = Scene(0.1);
  scene.duration_s = 15;
  scene.path_m = 60;
  scene.fix.rate_hz = 4;
  scene.fix.own_frame = true;
  const Dataset dataset = SimulateOrDie(scene, 3);
  RunIdentity identity;
  identity.config = Preset(GetParam());
  const RunResult run = RunWithFixes(identity.config, dataset, 3, 2);
  ASSERT_TRUE(run.global.has_value()) << run.align_report;
  EXPECT_FALSE(run.global->enu.has_value());
  const std::string folder = testing::TempDir() + "fix_run_" + std::string(ToString(GetParam()));
  ASSERT_TRUE(WriteRun(identity, run, folder).ok());
  EXPECT_FALSE(std::filesystem::exists(folder + "/trajectory.pos")) << "a file of raw GNSS";
  const Result<RunResult> read = ReadRun(folder);
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_TRUE(read->global.has_value());
  EXPECT_EQ(read->global->source, SensorOf<PositionFixEntry>());
  EXPECT_EQ(read->global->stamp_ns, run.global->stamp_ns);
  EXPECT_EQ(read->global->yaw_rad, run.global->yaw_rad);
  EXPECT_FALSE(read->global->enu.has_value());
  int used = 0;
  for (size_t i = 0; i < run.records.size(); ++i) {
    EXPECT_EQ(read->records[i].status, run.records[i].status);
    const SensorStatistics& counts = run.records[i].statistics.sensors[SensorOf<PositionFixEntry>()];
    const SensorStatistics& counts_read = read->records[i].statistics.sensors[SensorOf<PositionFixEntry>()];
    EXPECT_EQ(counts_read.used, counts.used);
    EXPECT_EQ(counts_read.gated, counts.gated);
    EXPECT_EQ(counts_read.nis, counts.nis);
    EXPECT_EQ(counts_read.nis_dof, counts.nis_dof);
    used += counts.used;
  }
  EXPECT_GT(used, 10);
  std::filesystem::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, FixRunTest, testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& backend) { return std::string(ToString(backend.param)); });

}  // namespace
}  // namespace alidade::test
