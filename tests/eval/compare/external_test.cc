#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/lie.h"
#include "eval/compare/external_cell.h"
#include "eval/compare/external_run.h"
#include "eval/compare/external_times.h"
#include "eval/trajectory/external_trajectory.h"
#include "gnss/base/geodesy.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

class External : public testing::Test {
 protected:
  Result<Trajectory> Read(const std::string& name, const std::string& text) {
    return ReadExternalTrajectory(folder_.Write(name, text), &context_);
  }
  test::TemporaryFolder folder_;
  ExternalContext context_;
};

// A quarter turn about z, body to world: Hamilton (w, z) = (sqrt(1/2), sqrt(1/2)).
const Eigen::Matrix3d kTurn = so3::Exp(Eigen::Vector3d(0, 0, M_PI / 2));

TEST_F(External, VinsMonoResult) {
  const Result<Trajectory> t = Read("vins.csv",
                                    "1403636580838555648,1.5,-2,3,0.70710678,0,0,0.70710678,0.1,0,0,\n"
                                    "1403636580888555648,1.6,-2,3,0.70710678,0,0,0.70710678,0.1,0,0,\n");
  ASSERT_TRUE(t.ok()) << t.message();
  ASSERT_EQ(t->points.size(), 2u);
  EXPECT_EQ(t->points[0].stamp_ns, 1403636580838555648);
  EXPECT_EQ(t->points[0].nav.p_WB, Eigen::Vector3d(1.5, -2, 3));
  EXPECT_LT((t->points[0].nav.R_WB - kTurn).norm(), 1e-7);
}

TEST_F(External, OpenVinsStateAndTrajectory) {
  const Result<Trajectory> state =
      Read("state.txt",
           "# timestamp(s) q p v bg ba cam_imu_dt\n"
           "1403636580.838555648 0 0 0.70710678 0.70710678 1.5 -2 3 0 0 0 0 0 0 0 0 0 0.01\n");
  ASSERT_TRUE(state.ok()) << state.message();
  EXPECT_EQ(state->points[0].stamp_ns, 1403636580838555648);
  EXPECT_EQ(state->points[0].nav.p_WB, Eigen::Vector3d(1.5, -2, 3));
  EXPECT_LT((state->points[0].nav.R_WB - kTurn).norm(), 1e-7);
  const Result<Trajectory> trajectory = Read("traj.txt",
                                             "# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12\n"
                                             "1403636580.838555648 1.5 -2 3 0 0 0.70710678 0.70710678 1 2\n");
  ASSERT_TRUE(trajectory.ok()) << trajectory.message();
  EXPECT_LT((trajectory->points[0].nav.R_WB - kTurn).norm(), 1e-7);
}

TEST_F(External, KittiTakesTheStampsOfTheCameraAndItsFrame) {
  const std::string rows = "0 -1 0 1 1 0 0 2 0 0 1 3\n0 -1 0 1 1 0 0 2 0 0 1 4\n";
  EXPECT_THAT(Read("kitti.txt", rows).message(), HasSubstr("one row a camera stamp"));
  context_.camera_stamps = {100, 200};
  const Result<Trajectory> body = Read("kitti.txt", rows);
  ASSERT_TRUE(body.ok()) << body.message();
  EXPECT_EQ(body->points[1].stamp_ns, 200);
  EXPECT_LT((body->points[1].nav.R_WB - kTurn).norm(), 1e-12);
  EXPECT_EQ(body->points[1].nav.p_WB, Eigen::Vector3d(1, 2, 4));
  // The camera sits at (0.5, 0, 0) of the body, turned by R_BC: p_WC = p_WB + R_WB p_BC.
  context_.T_BC = Pose{so3::Exp(Eigen::Vector3d(0.3, -0.2, 0.1)), Eigen::Vector3d(0.5, 0, 0)};
  const Result<Trajectory> camera = Read("kitti.txt", rows);
  ASSERT_TRUE(camera.ok()) << camera.message();
  const NavState& nav = camera->points[1].nav;
  EXPECT_LT((nav.p_WB + nav.R_WB * context_.T_BC->translation - Eigen::Vector3d(1, 2, 4)).norm(), 1e-12);
  EXPECT_LT((nav.R_WB * context_.T_BC->rotation - kTurn).norm(), 1e-12);
}

// GIVEN a camera whose stamps are 13 ms before IMU time THEN the rows of its frames are in IMU time, as truth
// is.
TEST_F(External, KittiRowsOfACellAreInImuTime) {
  PlanEstimator estimator;
  PlanSequence sequence;
  sequence.name = "seq";
  estimator.trajectories["seq"] =
      folder_.Write("kitti.txt", "1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 2 0 0 1 4\n");
  MeasurementLog log;
  log.rig.camera_time_offset_s = 0.013;
  log.frames.resize(2);
  log.frames[0].stamp_ns = kSecondNs;
  log.frames[1].stamp_ns = 2 * kSecondNs;
  const Result<ExternalOutcome> outcome =
      TrajectoryOfExternal({estimator, sequence, 1, log, nullptr, "", ""}, false, nullptr);
  ASSERT_TRUE(outcome.ok()) << outcome.message();
  EXPECT_EQ(outcome->trajectory.points[0].stamp_ns, kSecondNs + 13'000'000);
  EXPECT_EQ(outcome->trajectory.points[1].stamp_ns, 2 * kSecondNs + 13'000'000);
}

TEST_F(External, PositionFilesAreEnuInImuTime) {
  context_.gnss_time_offset_s = -18;
  const Result<Trajectory> t = Read("a.pos",
                                    "%  GPST latitude(deg) longitude(deg) height(m) Q ns\n"
                                    "2023/11/14 22:13:21.000 22.300000000 114.2 5.0 1 9\n"
                                    "2288 252802.100 22.300010000 114.2 6.0 5 9\n");
  ASSERT_TRUE(t.ok()) << t.message();
  EXPECT_FALSE(t->has_orientation);
  ASSERT_EQ(t->points.size(), 2u);
  EXPECT_EQ(t->points[1].stamp_ns - t->points[0].stamp_ns, 1'100'000'000);
  EXPECT_EQ(t->points[0].stamp_ns, 1'700'000'001'000'000'000 - 18'000'000'000);
  EXPECT_LT(t->points[0].nav.p_WB.norm(), 1e-6);
  EXPECT_NEAR(t->points[1].nav.p_WB.y(), 1.1075, 1e-3);
  EXPECT_NEAR(t->points[1].nav.p_WB.z(), 1, 1e-5);
  EXPECT_TRUE(context_.anchor_E.has_value());
  const Eigen::Vector3d& e = *context_.anchor_E;
  const Result<Trajectory> ecef =
      Read("b.pos", "%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns\n2288 252802.1 " + std::to_string(e.x()) +
                        " " + std::to_string(e.y()) + " " + std::to_string(e.z()) + " 5 9\n");
  ASSERT_TRUE(ecef.ok()) << ecef.message();
  EXPECT_LT(ecef->points[0].nav.p_WB.norm(), 1e-5);
  EXPECT_THAT(Read("c.pos", "2288 252802.1 95 114 5\n").message(), HasSubstr("c.pos:1: "));
  EXPECT_THAT(Read("d.pos", "2023/13/40 22:13:21.000 22 114 5\n").message(), HasSubstr("d.pos:1: "));
  EXPECT_FALSE(Read("e.pos", "% nothing\n").ok());
}

TEST_F(External, OtherFilesReadAsEver) {
  const Result<Trajectory> tum = Read("a.tum", "1.5 1 2 3 0 0 0 1\n2.5 1 2 3 0 0 0 1\n");
  ASSERT_TRUE(tum.ok()) << tum.message();
  EXPECT_EQ(tum->points[0].stamp_ns, 1'500'000'000);
  EXPECT_FALSE(Read("b.txt", "hello\n").ok());
  EXPECT_THAT(Read("c.csv", "1403636580838555648,1,2\n").message(), HasSubstr("c.csv:1"));
  EXPECT_THAT(Read("d.csv", "2,1,2,3,1,0,0,0\n1,1,2,3,1,0,0,0\n").message(), HasSubstr("d.csv:2"));
}

TEST(FillCommandTest, WordsAreQuotedAndChecked) {
  EXPECT_EQ(*FillCommand("run {dataset} > {output}/x ${HOME} {1}", {{"dataset", "/a b's"}, {"output", "/o"}}),
            "run '/a b'\\''s' > '/o'/x ${HOME} {1}");
  EXPECT_THAT(FillCommand("run {datset}", {{"dataset", "x"}}).message(), HasSubstr("dataset"));
}

TEST(ExternalTimesTest, ColumnsAreFoundByTheirNames) {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    return ReadExternalTimes(folder.Write("timing.csv", text));
  };
  const Result<ExternalTimes> times =
      read("timestamp_ns,frontend_ms,propagate_ms,backend_ms\n1,2,9,3\n2,4,9,5\n");
  ASSERT_TRUE(times.ok()) << times.message();
  EXPECT_THAT(times->frontend_ms, testing::ElementsAre(2, 4));
  EXPECT_THAT(times->backend_ms, testing::ElementsAre(3, 5));
  EXPECT_THAT(times->stamps_ns, testing::ElementsAre(1, 2));
  EXPECT_TRUE(read("frontend_ms,backend_ms\n1,2\n")->stamps_ns.empty());
  EXPECT_THAT(read("timestamp_ns,frontend_ms,backend_ms\n0.5,1,2\n").message(), HasSubstr("timing.csv:2"));
  EXPECT_THAT(read("timestamp_ns,frontend_ms\n1,2\n").message(), HasSubstr("a column backend_ms"));
  EXPECT_THAT(read("frontend_ms,backend_ms\n1,x\n").message(), HasSubstr("timing.csv:2"));
  EXPECT_THAT(read("frontend_ms,backend_ms\n").message(), HasSubstr("no row"));
}

TEST(RunExternalTest, TimesSucceedsFailsAndEnds) {
  const test::TemporaryFolder folder;
  const std::string log = folder.File("log");
  const Result<ExternalRun> fine = RunExternal("echo hello; echo there >&2; sleep 0.2", log, 10, nullptr);
  ASSERT_TRUE(fine.ok()) << fine.message();
  EXPECT_GE(fine->wall_s, 0.2);
  EXPECT_EQ(test::ReadFile(log), "hello\nthere\n");
  EXPECT_THAT(RunExternal("echo no data; exit 3", log, 10, nullptr).message(), HasSubstr("code 3: no data"));
  // What the shell started is ended with it.
  EXPECT_THAT(RunExternal("sleep 60 & wait", log, 0.2, nullptr).message(), HasSubstr("longer than 0.2 s"));
  const std::atomic<bool> stop = true;
  EXPECT_THAT(RunExternal("sleep 60", log, 60, &stop).message(), HasSubstr("stopped"));
}

/// A program on a folder, whose runs are counted.
class ExternalCellTest : public testing::Test {
 protected:
  ExternalCellTest() {
    sequence_.name = "walk";
    sequence_.dataset.path = folder_.path();
    Program("all/a.sh");
    Program("all/b.sh");
    estimator_.command.program = folder_.File("all/a.sh");
    estimator_.command.text = "sh {program} {output} {seed}";
  }

  void Program(const std::string& name) {
    folder_.Write(name, "echo ran >> " + folder_.File("runs") +
                            "\nprintf '1.5 1 2 3 0 0 0 1\\n2.5 1 2 3 0 0 0 1\\n' > $1/trajectory.tum\n"
                            "cp $1/trajectory.tum $1/other.tum\ntest ! -e " +
                            folder_.File("fail") + "\n");
  }

  Result<ExternalOutcome> Outcome(bool resume) {
    const ExternalCell cell{estimator_, sequence_, seed_, log_, nullptr, digest_, folder_.File(cell_)};
    return TrajectoryOfExternal(cell, resume, nullptr);
  }
  bool Kept() {
    const Result<ExternalOutcome> outcome = Outcome(true);
    EXPECT_TRUE(outcome.ok()) << outcome.message();
    return outcome.ok() && outcome->reused;
  }

  test::TemporaryFolder folder_;
  PlanEstimator estimator_;
  PlanSequence sequence_;
  MeasurementLog log_;
  unsigned seed_ = 1;
  std::string digest_ = "d";
  std::string cell_ = "all/out/cell";
};

TEST_F(ExternalCellTest, OnlyTheSameCommandIsKept) {
  EXPECT_FALSE(Kept());
  EXPECT_TRUE(Kept());
  EXPECT_EQ(test::ReadFile(folder_.File("runs")), "ran\n");
  estimator_.command.program = folder_.File("all/b.sh");
  EXPECT_FALSE(Kept()) << "another program by the same text";
  EXPECT_TRUE(Kept());
  estimator_.command.result = "other.tum";
  EXPECT_FALSE(Kept()) << "a file that happens to be there";
  EXPECT_TRUE(Kept());
  seed_ = 2;
  EXPECT_FALSE(Kept());
  EXPECT_TRUE(Kept());
  digest_ = "e";
  EXPECT_FALSE(Kept());
  estimator_.command.text += " ";
  EXPECT_FALSE(Kept());
  EXPECT_TRUE(Kept());
}

TEST_F(ExternalCellTest, AFailedRunIsNotKeptThoughItLeftItsResult) {
  EXPECT_FALSE(Kept());
  folder_.Write("fail", "");
  EXPECT_FALSE(Outcome(false).ok());
  EXPECT_TRUE(std::filesystem::exists(folder_.File("all/out/cell/trajectory.tum")));
  EXPECT_FALSE(Outcome(true).ok());
  std::filesystem::remove(folder_.File("fail"));
  EXPECT_FALSE(Kept());
  EXPECT_TRUE(Kept());
}

// GIVEN folders that were moved, the output alone or with the program beside it, THEN the run is kept.
TEST_F(ExternalCellTest, AMovedRunIsKept) {
  EXPECT_FALSE(Kept());
  std::filesystem::rename(folder_.File("all/out"), folder_.File("moved"));
  cell_ = "moved/cell";
  EXPECT_TRUE(Kept());
  estimator_.command.program = folder_.File("all/../all/a.sh");
  EXPECT_TRUE(Kept()) << "the same place by another name";
  std::filesystem::rename(folder_.File("moved"), folder_.File("all/out"));
  std::filesystem::rename(folder_.File("all"), folder_.File("whole"));
  estimator_.command.program = folder_.File("whole/a.sh");
  cell_ = "whole/out/cell";
  EXPECT_TRUE(Kept());
  EXPECT_EQ(test::ReadFile(folder_.File("runs")), "ran\n");
}

}  // namespace
}  // namespace alidade
