#include "eval/simulation/recorded_motion.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "eval/dataset/dataset.h"
#include "eval/dataset/dataset_writer.h"
#include "eval/simulation/sim_imu.h"
#include "eval/simulation/simulator.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

SimulatorConfig ShortConfig() {
  SimulatorConfig config;
  config.duration_s = 12;
  config.path_m = 15.7;
  return config;
}

/// Points every 10 ms, stamped from 100 s on.
Trajectory EvenPoints(int count) {
  Trajectory trajectory;
  for (TimeNs k = 0; k < count; ++k) {
    TrajectoryPoint point;
    point.stamp_ns = 100000000000 + k * 10000000;
    trajectory.points.push_back(point);
  }
  return trajectory;
}

TEST(RecordedMotionTest, KeepsTheLongestStretchWithoutAGap) {
  Trajectory trajectory = EvenPoints(1000);
  EXPECT_EQ(KeepGapFree(trajectory, 0.2, TruthGaps::kRefuse)->points.size(), 1000u);
  trajectory.points.erase(trajectory.points.begin() + 700, trajectory.points.begin() + 730);
  trajectory.points.erase(trajectory.points.begin() + 100, trajectory.points.begin() + 130);
  const Trajectory kept = KeepGapFree(trajectory, 0.2, TruthGaps::kLongestSpan).value();
  ASSERT_EQ(kept.points.size(), 570u);
  EXPECT_EQ(kept.points.front().stamp_ns, 101300000000);
  EXPECT_EQ(kept.points.back().stamp_ns, 106990000000);
  EXPECT_EQ(KeepGapFree(trajectory, 0.32, TruthGaps::kRefuse)->points.size(), 940u);
  const Result<Trajectory> refused = KeepGapFree(trajectory, 0.2, TruthGaps::kRefuse);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.code(), StatusCode::kInput);
  EXPECT_NE(refused.message().find("2 gaps longer than max_gap_s 0.2"), std::string::npos);
}

TEST(RecordedMotionTest, TheRecomputedTruthGoesFirst) {
  const test::TemporaryFolder folder;
  const std::string truth = "mav0/state_groundtruth_estimate0/";
  EXPECT_EQ(FindTruth(folder.path(), "auto").code(), StatusCode::kInput);
  const std::string pose = folder.Write(truth + "data_pose.csv", "x");
  EXPECT_EQ(FindTruth(folder.path(), "auto").value(), pose);
  const std::string official = folder.Write(truth + "data.csv", "x");
  EXPECT_EQ(FindTruth(folder.path(), "auto").value(), official);
  const std::string recomputed = folder.Write(truth + "data_recomputed.csv", "x");
  EXPECT_EQ(FindTruth(folder.path(), "auto").value(), recomputed);
  EXPECT_EQ(FindTruth(folder.path(), "data.csv").value(), official);
  EXPECT_EQ(FindTruth(official, "auto").value(), official);
  EXPECT_EQ(FindTruth(folder.path(), "no.csv").code(), StatusCode::kInput);
  EXPECT_EQ(FindTruth(folder.File("no_folder"), "auto").code(), StatusCode::kInput);
}

TEST(RecordedMotionTest, ASequenceAlongARecordedPathFollowsIt) {
  const test::TemporaryFolder folder;
  const Dataset original = Simulate(ShortConfig(), 1).value();
  ASSERT_TRUE(WriteDataset(original, folder.path()).ok());

  SimulatorConfig config;
  config.trajectory = SimTrajectory::kFile;
  config.trajectory_file = folder.path();
  config.camera_view = SimCameraView::kDataset;
  config.imu_noise = {0, 0, 0, 0};
  config.gyro_bias_radps = config.accel_bias_mps2 = 0;
  const Result<Dataset> again = Simulate(config, 2);
  ASSERT_TRUE(again.ok()) << again.message();
  EXPECT_EQ(again->rig.T_BC.rotation, original.rig.T_BC.rotation);
  EXPECT_EQ(again->rig.camera.intrinsics(), original.rig.camera.intrinsics());
  ASSERT_EQ(again->imu.size(), 1201u);
  ASSERT_EQ(again->frames.size(), 121u);
  for (std::size_t k = 0; k < again->imu.size(); ++k) {
    ASSERT_EQ(again->imu[k].stamp_ns, original.imu[k].stamp_ns);
    const NavState& there = original.truth->points[k].nav;
    const NavState& here = again->truth->points[k].nav;
    ASSERT_LT((here.p_WB - there.p_WB).norm(), 1e-5);
    ASSERT_LT(so3::Log(here.R_WB.transpose() * there.R_WB).norm(), 1e-4);
    if (k > 20 && k < 1180) {
      ASSERT_LT((again->imu[k].gyro - original.imu[k].gyro + original.truth->points[k].bias.gyro).norm(),
                0.02);
    }
  }
  config.duration_s = 5;
  EXPECT_EQ(Simulate(config, 2)->imu.size(), 501u) << "at most duration_s";
}

TEST(RecordedMotionTest, MissingPathsAndRecordingsAreNamed) {
  SimulatorConfig config;
  config.trajectory = SimTrajectory::kFile;
  EXPECT_EQ(Simulate(config, 1).code(), StatusCode::kConfig);
  EXPECT_NE(Simulate(config, 1).message().find("trajectory_file"), std::string::npos);
  config.trajectory_file = "no_such_file.csv";
  EXPECT_EQ(Simulate(config, 1).code(), StatusCode::kInput);
  EXPECT_NE(Simulate(config, 1).message().find("no_such_file.csv"), std::string::npos);
  config.camera_view = SimCameraView::kDataset;
  EXPECT_EQ(Simulate(config, 1).code(), StatusCode::kConfig);
  EXPECT_NE(Simulate(config, 1).message().find("camera_view"), std::string::npos);
}

}  // namespace
}  // namespace alidade
