#include "eval/run/fix_run.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/robust.h"
#include "filter/filter.h"
#include "gnss/base/anchor_llh.h"
#include "tests/support/scenario.h"

namespace alidade::test {
namespace {

using Eigen::Vector3d;

/// What became of one run.
struct FixScore {
  double aligned_s = -1;  ///< since the start of the motion
  int used = 0;
  int gated = 0;
  int frames = 0;            ///< after the alignment
  double nees_position = 0;  ///< mean over them, 3 is ideal
  double rmse_m = 0;
  double nis = 0;
  int nis_dof = 0;
};

/// Figure-8 of 500 m in 120 s (4 m/s) with position fixes.
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

EstimatorConfig Preset() {
  EstimatorConfig config;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.window = 12;
  config.filter.clone_policy = ClonePolicy::kOldest;
  config.filter.track_memory = TrackMemoryPolicy::kWindow;
  config.fix.enabled = true;
  return config;
}

/// The filter starts in a local world that is turned by `yaw_rad` and shifted against that of the fixes.
FixScore RunWithFixes(const Dataset& dataset, unsigned seed, double yaw_rad) {
  FixScore score;
  NavEstimate start = DrawInitialState(dataset, seed);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  start.nav = {turn * start.nav.R_WB, turn * start.nav.p_WB + Vector3d(7, -3, 2), turn * start.nav.v_WB};
  const EstimatorConfig config = Preset();
  const std::unique_ptr<Estimator> filter = MakeFilter(config, dataset.rig);
  FixRun fixes(config, dataset.rig, false, filter.get());
  for (const PositionFix& fix : dataset.fixes) {
    EXPECT_EQ(fixes.feed().Add(fix), FixFeed::Arrival::kTaken);
  }
  EXPECT_TRUE(filter->Initialize(start).ok());
  std::size_t imu = 0;
  const auto deliver = [&](TimeNs stamp_ns) {
    for (; imu < dataset.imu.size() && (imu == 0 || dataset.imu[imu - 1].stamp_ns < stamp_ns); ++imu) {
      EXPECT_TRUE(filter->AddImu(dataset.imu[imu]).ok());
    }
  };
  for (const TrackFrame& frame : dataset.tracks) {
    while (const PositionFix* fix = fixes.feed().Next()) {
      if (fix->stamp_ns >= frame.stamp_ns) {
        break;
      }
      deliver(fix->stamp_ns);
      const Result<FixRun::Outcome> outcome = fixes.Take();
      EXPECT_TRUE(outcome.ok()) << outcome.message();
      if (outcome.ok() && *outcome == FixRun::Outcome::kTaken) {
        const FrameStatistics& statistics = filter->last_statistics();
        score.used += statistics.fixes_used;
        score.gated += statistics.fixes_gated;
        score.nis += statistics.fix_nis;
        score.nis_dof += statistics.fix_nis_dof;
      }
    }
    deliver(frame.stamp_ns);
    EXPECT_TRUE(filter->AddFrame(frame).ok());
    const auto alignment = fixes.Align(filter->Latest());
    EXPECT_TRUE(alignment.ok()) << alignment.message();
    if (alignment.ok() && *alignment) {
      score.aligned_s = SecondsBetween(dataset.tracks.front().stamp_ns, frame.stamp_ns);
    }
    if (!fixes.aligned()) {
      continue;
    }
    const NavEstimate now = filter->Latest();
    const Vector3d error = now.nav.p_WB - TruthAt(dataset, now.stamp_ns).nav.p_WB;
    score.nees_position += error.dot(now.covariance.block<3, 3>(3, 3).ldlt().solve(error));
    score.rmse_m += error.squaredNorm();
    ++score.frames;
  }
  score.nees_position /= std::max(score.frames, 1);
  score.rmse_m = std::sqrt(score.rmse_m / std::max(score.frames, 1));
  return score;
}

/// Mean over `runs` runs with seeds from `first_seed` on.
void ExpectConsistent(double std_m, unsigned first_seed, int runs, double max_rmse_m) {
  double nees = 0;
  double nis = 0;
  int nis_dof = 0;
  for (unsigned seed = first_seed; seed < first_seed + static_cast<unsigned>(runs); ++seed) {
    const Dataset dataset = SimulateOrDie(Scene(std_m), seed);
    const FixScore score = RunWithFixes(dataset, seed, 0.7 * seed);
    EXPECT_GE(score.aligned_s, 0) << "seed " << seed;
    EXPECT_LT(score.aligned_s, 15) << "seed " << seed;
    EXPECT_GE(score.gated, 3) << "seed " << seed;
    EXPECT_LT(score.rmse_m, max_rmse_m) << "seed " << seed;
    nees += score.nees_position / runs;
    nis += score.nis;
    nis_dof += score.nis_dof;
  }
  // Errors of a run are correlated over seconds: about ten independent ones a run.
  const double band = 4 * std::sqrt(2.0 * 3 / (10 * runs));
  EXPECT_NEAR(nees, 3, band);
  EXPECT_NEAR(nis / nis_dof, 1, 0.25);
}

TEST(FixRunTest, GIVEN_fixes_of_a_metre_an_outage_and_wrong_ones_THEN_the_filter_aligns_and_is_consistent) {
  ExpectConsistent(1, 11, 3, 1.5);
}

TEST(FixRunTest, GIVEN_fixes_of_2_cm_an_outage_and_wrong_ones_THEN_the_filter_aligns_and_is_consistent) {
  ExpectConsistent(0.02, 21, 3, 0.5);
}

RigCalibration TwoSensors(std::optional<Vector3d> first, std::optional<Vector3d> second) {
  RigCalibration rig;
  rig.fixes = {{Vector3d::Zero(), 0.5, first}, {Vector3d::Zero(), 0, second}};
  return rig;
}

TEST(FixFeedTest, GIVEN_two_sensors_on_Earth_THEN_fixes_come_in_IMU_time_and_in_one_frame) {
  const Vector3d here(47.4, 8.5, 450);
  const Vector3d there = LlhDegOf(EnuFrameAtLlh(here).ToEcef(Vector3d(1000, -2000, 30)));
  FixFeed feed(TwoSensors(here, there), false);
  using Arrival = FixFeed::Arrival;
  EXPECT_EQ(feed.Add({1'000'000'000, 0, Vector3d(1, 2, 3), Eigen::Matrix3d::Identity()}), Arrival::kTaken);
  EXPECT_EQ(feed.Add({1'400'000'000, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kTaken);
  EXPECT_EQ(feed.Add({1'400'000'000, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kTwice);
  EXPECT_EQ(feed.Add({1'400'000'000, 2, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kNoSensor);
  ASSERT_NE(feed.Next(), nullptr);
  EXPECT_EQ(feed.Next()->sensor, 1);
  EXPECT_LT((feed.Next()->p_A - Vector3d(1000, -2000, 30)).norm(), 1e-6);
  feed.Pop();
  EXPECT_EQ(feed.Next()->stamp_ns, 1'500'000'000);
  EXPECT_LT((feed.Next()->p_A - Vector3d(1, 2, 3)).norm(), 1e-9);
  EXPECT_EQ(feed.Add({1'300'000'000, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kTooLate);
}

TEST(FixFeedTest, GIVEN_frames_that_are_not_related_THEN_only_those_of_the_run_are_taken) {
  const Vector3d here(47.4, 8.5, 450);
  const PositionFix first{0, 0, Vector3d::Zero(), Eigen::Matrix3d::Identity()};
  const PositionFix second{0, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()};
  FixFeed own(TwoSensors(std::nullopt, here), false);
  EXPECT_EQ(own.Add(first), FixFeed::Arrival::kTaken);
  EXPECT_EQ(own.Add(second), FixFeed::Arrival::kUnrelated);
  EXPECT_FALSE(own.enu());
  FixFeed with_gnss(TwoSensors(std::nullopt, here), true);
  EXPECT_EQ(with_gnss.Add(first), FixFeed::Arrival::kUnrelated);
  EXPECT_EQ(with_gnss.Add(second), FixFeed::Arrival::kTaken);
  with_gnss.SetFrame(EnuFrame::At(EnuFrameAtLlh(here).ToEcef(Vector3d(0, 0, 100))));
  EXPECT_LT((with_gnss.Next()->p_A - Vector3d(0, 0, -100)).norm(), 1e-6);
}

}  // namespace
}  // namespace alidade::test
