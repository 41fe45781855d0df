#include "eval/record/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "eval/files/input_file.h"
#include "eval/record/recorder_reader.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "tests/eval/record/fake_estimator.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::StartsWith;

class RecorderTest : public testing::Test {
 protected:
  RecorderTest() {
    const test::RestingScene scene;
    identity_.config.init.method = InitMethod::kTruth;
    identity_.dataset = "rest";
    identity_.dataset_digest = "dd";
    identity_.input_digest = "ii";
    identity_.seed = 7;
    test::FakeEstimator estimator;
    RunOptions options;
    options.truth = &scene.truth;
    options.seed = identity_.seed;
    result_ = RunEstimator(identity_.config, scene.log, options, &estimator);
  }

  std::string Written(const std::string& name) const { return *ReadWholeFile(folder_.File("run/" + name)); }

  test::TemporaryFolder folder_;
  RunIdentity identity_;
  RunResult result_;
};

TEST_F(RecorderTest, WritesTheFormatsOfTheContract) {
  ASSERT_TRUE(WriteRun(identity_, result_, folder_.File("run")).ok());
  EXPECT_THAT(Written("trajectory.tum"), StartsWith("1000.000000000 "));
  EXPECT_THAT(
      Written("states.csv"),
      StartsWith(
          "timestamp_ns,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z,c_00,c_01,"
          "c_02,c_03,c_04,c_05,c_11,c_12,c_13,c_14,c_15,c_22,c_23,c_24,c_25,c_33,c_34,c_35,c_44,c_45,c_55"
          "\n1000000000000,"));
  EXPECT_THAT(
      Written("covariance.csv"),
      StartsWith("timestamp_ns,v_xx,v_xy,v_xz,v_yy,v_yz,v_zz,bg_xx,bg_xy,bg_xz,bg_yy,bg_yz,bg_zz,ba_xx,"
                 "ba_xy,ba_xz,ba_yy,ba_yz,ba_zz\n1000000000000,"));
  EXPECT_THAT(Written("timing.csv"),
              StartsWith("timestamp_ns,frontend_ms,propagate_ms,update_ms,backend_ms,total_ms\n"));
  EXPECT_THAT(Written("status.csv"), StartsWith("timestamp_ns,status,tracks_in,features_used,features_gated,"
                                                "satellites_used,satellites_gated,nis,"));
  // Eight columns, single spaces; of the two quaternions of a rotation the one with w >= 0.
  const std::string tum = Written("trajectory.tum");
  const std::string line = tum.substr(0, tum.find('\n'));
  EXPECT_EQ(std::count(line.begin(), line.end(), ' '), 7);
  EXPECT_GT(std::stod(line.substr(line.rfind(' '))), 0);
  const auto json = nlohmann::json::parse(Written("run.json"));
  EXPECT_EQ(json["status"], "ok");
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["config"]["init"]["method"], "truth");
  EXPECT_EQ(json["counts"]["frames_processed"], result_.records.size());
}

TEST_F(RecorderTest, ReadsBackWhatItWrote) {
  result_.records[2].statistics.features_used = 42;
  result_.records[3].statistics.iterations = 5;
  result_.records[3].statistics.at_rest = true;
  result_.frames_skipped = 3;
  result_.skip_report = "why";
  ASSERT_TRUE(WriteRun(identity_, result_, folder_.File("run")).ok());
  const Result<RunResult> read = ReadRun(folder_.File("run"));
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->records.size(), result_.records.size());
  EXPECT_EQ(read->init_method, "truth");
  EXPECT_EQ(read->init_stamp_ns, result_.init_stamp_ns);
  EXPECT_EQ(read->frames_skipped, 3);
  EXPECT_EQ(read->skip_report, "why");
  EXPECT_EQ(read->cpu_s, result_.cpu_s);
  for (size_t i = 0; i < read->records.size(); ++i) {
    const RunRecord& a = read->records[i];
    const RunRecord& b = result_.records[i];
    EXPECT_EQ(a.estimate.stamp_ns, b.estimate.stamp_ns);
    EXPECT_EQ(a.estimate.nav.p_WB, b.estimate.nav.p_WB);
    EXPECT_EQ(a.estimate.nav.v_WB, b.estimate.nav.v_WB);
    EXPECT_EQ(a.estimate.bias.gyro, b.estimate.bias.gyro);
    EXPECT_EQ(a.estimate.bias.accel, b.estimate.bias.accel);
    EXPECT_TRUE(a.estimate.nav.R_WB.isApprox(b.estimate.nav.R_WB, 1e-14));
    const Matrix6d covariance = b.estimate.covariance.topLeftCorner<6, 6>().selfadjointView<Eigen::Upper>();
    EXPECT_EQ((a.estimate.covariance.topLeftCorner<6, 6>()), covariance);
    for (const Eigen::Index first : {6, 9, 12}) {
      const Eigen::Matrix3d motion = b.estimate.covariance.block<3, 3>(first, first);
      const Eigen::Matrix3d symmetric = motion.selfadjointView<Eigen::Upper>();
      EXPECT_EQ((a.estimate.covariance.block<3, 3>(first, first)), symmetric) << first;
      EXPECT_GT(symmetric.trace(), 0);
    }
    EXPECT_EQ(a.statistics.tracks_in, b.statistics.tracks_in);
    EXPECT_EQ(a.statistics.features_used, b.statistics.features_used);
    EXPECT_EQ(a.statistics.iterations, b.statistics.iterations);
    EXPECT_EQ(a.statistics.at_rest, b.statistics.at_rest);
    EXPECT_EQ(a.statistics.nis, b.statistics.nis);
    EXPECT_EQ(a.statistics.gnss_nis, b.statistics.gnss_nis);
    EXPECT_EQ(a.statistics.gnss_nis_dof, b.statistics.gnss_nis_dof);
    EXPECT_EQ(a.frontend_ms, b.frontend_ms);
    EXPECT_EQ(a.backend_ms, b.backend_ms);
    EXPECT_EQ(a.status, b.status);
  }
}

TEST_F(RecorderTest, FilteringCovarianceHasAFileOfItsOwnOnlyWhereThereIsOne) {
  for (size_t i = 0; i < result_.records.size(); ++i) {
    const Vector6d column = Vector6d::LinSpaced(0.1, 0.1 + static_cast<double>(i));
    result_.records[i].filtering_covariance = Matrix6d::Identity() + column * column.transpose();
  }
  ASSERT_TRUE(WriteRun(identity_, result_, folder_.File("run")).ok());
  EXPECT_THAT(Written("bound.csv"), StartsWith("timestamp_ns,c_00,c_01,c_02,c_03,c_04,c_05,c_11"));
  Result<RunResult> read = ReadRun(folder_.File("run"));
  ASSERT_TRUE(read.ok()) << read.message();
  for (size_t i = 0; i < read->records.size(); ++i) {
    ASSERT_TRUE(read->records[i].filtering_covariance.has_value());
    EXPECT_EQ(*read->records[i].filtering_covariance, *result_.records[i].filtering_covariance);
  }
  for (RunRecord& record : result_.records) {
    record.filtering_covariance.reset();
  }
  ASSERT_TRUE(WriteRun(identity_, result_, folder_.File("run")).ok());
  EXPECT_FALSE(std::filesystem::exists(folder_.File("run/bound.csv"))) << "of an older run";
  read = ReadRun(folder_.File("run"));
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_FALSE(read->records.front().filtering_covariance.has_value());
}

TEST_F(RecorderTest, RunThatNeverStartedReadsBackEmpty) {
  RunResult failed;
  failed.status = Status::Diverged("moving");
  ASSERT_TRUE(WriteRun(identity_, failed, folder_.File("run")).ok());
  const Result<RunResult> read = ReadRun(folder_.File("run"));
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_EQ(StatusWord(*read), "not_initialized");
  EXPECT_EQ(read->status.message(), "moving");
  EXPECT_TRUE(read->records.empty());
}

TEST_F(RecorderTest, ResumesOnlyTheSameRun) {
  const std::string run = folder_.File("run");
  EXPECT_FALSE(HoldsRun(run, identity_));
  ASSERT_TRUE(WriteRun(identity_, result_, run).ok());
  EXPECT_TRUE(HoldsRun(run, identity_));
  RunIdentity other = identity_;
  other.config.filter.window = 11;
  EXPECT_FALSE(HoldsRun(run, other));
  other = identity_;
  other.input_digest = "jj";
  EXPECT_FALSE(HoldsRun(run, other));
  other = identity_;
  other.seed = 8;
  EXPECT_FALSE(HoldsRun(run, other));
  other = identity_;
  other.truth_digest = "tt";
  EXPECT_FALSE(HoldsRun(run, other)) << "a run that does not say what truth it started from";
  ASSERT_TRUE(WriteRun(other, result_, run).ok());
  EXPECT_TRUE(HoldsRun(run, other));
  other.truth_digest = "uu";
  EXPECT_FALSE(HoldsRun(run, other));
  result_.interrupted = true;
  ASSERT_TRUE(WriteRun(identity_, result_, run).ok());
  EXPECT_FALSE(HoldsRun(run, identity_));
}

TEST_F(RecorderTest, AnAuditIsWrittenReadBackAndAskedForOnResume) {
  const std::string run = folder_.File("run");
  RunIdentity audited = identity_;
  audited.audited = true;
  ASSERT_TRUE(WriteRun(identity_, result_, run).ok());
  EXPECT_FALSE(HoldsRun(run, audited));
  for (size_t i = 0; i < result_.records.size(); ++i) {
    RunRecord& record = result_.records[i];
    record.observability = {
        record.estimate.stamp_ns, static_cast<int>(i), 1e-21 * static_cast<double>(i), 2, 3, 0.25};
  }
  ASSERT_TRUE(WriteRun(audited, result_, run).ok());
  EXPECT_THAT(Written("observability.csv"),
              StartsWith("timestamp_ns,rank,yaw_leak,position_leak,yaw_gain,null_angle_rad\n"));
  EXPECT_TRUE(HoldsRun(run, audited));
  EXPECT_FALSE(HoldsRun(run, identity_)) << "its times are those of an audit";
  const Result<RunResult> read = ReadRun(run);
  ASSERT_TRUE(read.ok()) << read.message();
  for (size_t i = 0; i < read->records.size(); ++i) {
    ASSERT_TRUE(read->records[i].observability.has_value());
    const ObservabilityRecord& row = *read->records[i].observability;
    EXPECT_EQ(row.rank, static_cast<int>(i));
    EXPECT_EQ(row.yaw_leak, 1e-21 * static_cast<double>(i));
    EXPECT_EQ(row.position_leak, 2);
    EXPECT_EQ(row.yaw_gain, 3);
    EXPECT_EQ(row.null_angle_rad, 0.25);
  }
  ASSERT_TRUE(WriteRun(identity_, result_, run).ok());
  EXPECT_FALSE(std::filesystem::exists(folder_.File("run/observability.csv")))
      << "a stale audit must not stay";
}

TEST_F(RecorderTest, TornTablesAreNoRun) {
  ASSERT_TRUE(WriteRun(identity_, result_, folder_.File("run")).ok());
  folder_.Write("run/status.csv", "timestamp_ns,status\n");
  EXPECT_EQ(ReadRun(folder_.File("run")).code(), StatusCode::kInput);
  folder_.Write("run/run.json", "{ torn");
  EXPECT_EQ(ReadRun(folder_.File("run")).code(), StatusCode::kInput);
  EXPECT_FALSE(HoldsRun(folder_.File("run"), identity_));
}

TEST_F(RecorderTest, FolderThatCannotBeMadeIsAnOutputFault) {
  folder_.Write("file", "x");
  EXPECT_EQ(WriteRun(identity_, result_, folder_.File("file") + "/run").code(), StatusCode::kOutput);
}

}  // namespace
}  // namespace alidade
