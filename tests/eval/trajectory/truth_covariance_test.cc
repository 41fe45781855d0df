#include "eval/trajectory/truth_covariance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random.h"
#include "eval/trajectory/trajectory_reader.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

const char* const kPoses =
    "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n"
    "1000,1,2,3,1,0,0,0\n"
    "2000,1,2,3,1,0,0,0\n";

Trajectory WithCovariance() {
  RandomStream random(1, "covariance");
  Trajectory truth;
  truth.has_covariance = true;
  for (const TimeNs stamp_ns : {1000, 2000}) {
    TrajectoryPoint& point = truth.points.emplace_back();
    point.stamp_ns = stamp_ns;
    const Matrix6d root = Matrix6d::NullaryExpr([&] { return 1e-3 * random.Normal(); });
    point.covariance = root * root.transpose();
  }
  return truth;
}

TEST(TruthCovarianceTest, GivenAFileBesideTheTruthThenItsRowsHaveThoseCovariances) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("data_pose.csv", kPoses);
  EXPECT_FALSE(ReadTrajectory(path)->has_covariance);
  const Trajectory written = WithCovariance();
  folder.Write("data_pose_covariance.csv", CovarianceCsv(written));
  const Result<Trajectory> read = ReadTrajectory(path);
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_TRUE(read->has_covariance);
  for (size_t i = 0; i < 2; ++i) {
    const Matrix6d upper = written.points[i].covariance.triangularView<Eigen::Upper>();
    const Matrix6d same = read->points[i].covariance.triangularView<Eigen::Upper>();
    EXPECT_EQ(same, upper) << "bit for bit";
    EXPECT_EQ(read->points[i].covariance, read->points[i].covariance.transpose());
  }
  EXPECT_FALSE(ReadTrajectory(folder.Write("other.csv", kPoses))->has_covariance) << "not its own";
}

TEST(TruthCovarianceTest, GivenRowsOfAnotherTruthThenTheyAreRefused) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("data.csv", kPoses);
  Trajectory covariances = WithCovariance();
  const auto message = [&] {
    folder.Write("data_covariance.csv", CovarianceCsv(covariances));
    const Result<Trajectory> read = ReadTrajectory(path);
    EXPECT_EQ(read.code(), StatusCode::kInput);
    return read.message();
  };
  covariances.points[1].stamp_ns = 2001;
  EXPECT_THAT(message(), HasSubstr("data_covariance.csv:3"));
  covariances.points[1].stamp_ns = 2000;
  covariances.points[0].covariance(2, 2) = -1;
  EXPECT_THAT(message(), HasSubstr("not negative"));
  covariances = WithCovariance();
  covariances.points.pop_back();
  EXPECT_THAT(message(), HasSubstr("holds 1 rows"));
  covariances = WithCovariance();
  covariances.points.push_back(covariances.points.back());
  EXPECT_THAT(message(), HasSubstr("ends before"));
}

}  // namespace
}  // namespace alidade
