#include "eval/trajectory/trajectory_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/trajectory/trajectory.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

std::string StatesHeader() {
  std::string text = "timestamp_ns,p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z";
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) {
      text += ",c_" + std::to_string(row) + std::to_string(col);
    }
  }
  return text;
}

/// The upper triangle with entry (row, col) = 10 row + col + 1.
std::string Triangle() {
  std::string text;
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) {
      text += "," + std::to_string(10 * row + col + 1);
    }
  }
  return text;
}

TEST(TrajectoryReader, GivenTumThenStampsKeepEveryNanosecond) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write("a.tum",
                                        "# stamp x y z qx qy qz qw\n"
                                        "1403715273.262142976 1 2 3 0 0 0.6 0.8\n"
                                        "1403715273.2621429764 1 2 3 0 0 0.6 0.8\n"
                                        "1.403715274e+09\t4 5 6   0 0 0 1\r\n");
  // The second row's tenth decimal rounds to the same nanosecond.
  const Result<Trajectory> same = ReadTrajectory(path);
  ASSERT_FALSE(same.ok());
  EXPECT_THAT(same.message(), HasSubstr("a.tum:3"));
  const Result<Trajectory> read = ReadTrajectory(folder.Write("b.txt",
                                                              "1403715273.262142976 1 2 3 0 0 0.6 0.8\n"
                                                              "1403715273.2621429766 1 2 3 0 0 0.6 0.8\n"
                                                              "1.403715274e+09\t4 5 6   0 0 0 1\r\n"));
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->points.size(), 3u);
  EXPECT_EQ(read->points[0].stamp_ns, 1403715273262142976);
  EXPECT_EQ(read->points[1].stamp_ns, 1403715273262142977);
  EXPECT_EQ(read->points[2].stamp_ns, 1403715274000000000);
  EXPECT_EQ(read->points[2].nav.p_WB, Eigen::Vector3d(4, 5, 6));
  const Eigen::Vector3d turned = read->points[0].nav.R_WB * Eigen::Vector3d::UnitX();
  EXPECT_LT((turned - Eigen::Vector3d(0.28, 0.96, 0)).norm(), 1e-15) << "w is the last column";
  EXPECT_FALSE(read->has_velocity || read->has_bias || read->has_covariance);
}

TEST(TrajectoryReader, GivenNanosecondsWhereTumWantsSecondsThenTheMessageNamesTheUnit) {
  const test::TemporaryFolder folder;
  const Result<Trajectory> read =
      ReadTrajectory(folder.Write("a.tum", "1403715273262142976 1 2 3 0 0 0 1\n"));
  EXPECT_EQ(read.code(), StatusCode::kInput);
  EXPECT_THAT(read.message(), HasSubstr("a.tum:1: column 1 (stamp)"));
  EXPECT_THAT(read.message(), HasSubstr("nanoseconds written as seconds?"));
}

TEST(TrajectoryReader, GivenRepeatedZeroRowsBeforeTheStartThenTheyAreNoPoses) {
  const test::TemporaryFolder folder;
  const std::string zero = "0.000000 0 0 0 0 0 0 1\n";
  const Result<Trajectory> read =
      ReadTrajectory(folder.Write("a.tum", zero + zero + zero + "5.5 1 2 3 0 0 0 1\n"));
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_EQ(read->points.size(), 1u);
  EXPECT_EQ(read->points[0].stamp_ns, 5'500'000'000);
  const Result<Trajectory> from_zero = ReadTrajectory(folder.Write("b.tum", zero + "0.1 1 2 3 0 0 0 1\n"));
  ASSERT_TRUE(from_zero.ok()) << from_zero.message();
  EXPECT_EQ(from_zero->points.size(), 2u) << "a trajectory may start at time zero";
}

TEST(TrajectoryReader, GivenStatesWithCovarianceAndClockTermsThenBothHalvesOfTheTriangleAreFilled) {
  const test::TemporaryFolder folder;
  const Result<Trajectory> read = ReadTrajectory(
      folder.Write("states.csv",
                   StatesHeader() + ",clock_m\n5,1,2,3,1,0,0,0,4,5,6,7,8,9,10,11,12" + Triangle() + ",99\n"));
  ASSERT_TRUE(read.ok()) << read.message();
  ASSERT_TRUE(read->has_velocity && read->has_bias && read->has_covariance);
  const TrajectoryPoint& point = read->points.at(0);
  EXPECT_EQ(point.nav.v_WB, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(point.bias.gyro, Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(point.bias.accel, Eigen::Vector3d(10, 11, 12));
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) {
      EXPECT_EQ(point.covariance(row, col), 10 * row + col + 1);
      EXPECT_EQ(point.covariance(col, row), 10 * row + col + 1);
    }
  }
}

TEST(TrajectoryReader, GivenANegativeVarianceOrAMissingEntryThenItIsAnError) {
  const test::TemporaryFolder folder;
  std::string negative = Triangle();
  negative.replace(negative.find(",23"), 3, ",-1");  // c_22
  const std::string state = "5,1,2,3,1,0,0,0,4,5,6,7,8,9,10,11,12";
  const Result<Trajectory> read =
      ReadTrajectory(folder.Write("states.csv", StatesHeader() + "\n" + state + negative));
  EXPECT_EQ(read.code(), StatusCode::kInput);
  EXPECT_THAT(read.message(), HasSubstr("states.csv:2: column 29"));
  EXPECT_THAT(read.message(), HasSubstr("not negative"));
  const Result<Trajectory> torn =
      ReadTrajectory(folder.Write("torn.csv", StatesHeader() + "\n" + state + ",1,2\n"));
  EXPECT_THAT(torn.message(), HasSubstr("torn row: found 19 columns, expected 38"));
}

TEST(TrajectoryReader, GivenEurocsOwnHeaderThenItsVariantsAreTheSame) {
  const test::TemporaryFolder folder;
  // The published files have "#timestamp" without a unit and put blanks after the commas.
  const Result<Trajectory> read = ReadTrajectory(folder.Write(
      "data.csv",
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad "
      "s^-1], "
      "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\r\n"
      "1403636580838555648,4.6,-1.7,0.7,0.534108,-0.153029,-0.827383,-0.082152,1,2,3,4,5,6,7,8,9\r\n"));
  ASSERT_TRUE(read.ok()) << read.message();
  const Eigen::Matrix3d& R = read->points.at(0).nav.R_WB;
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14) << "six digits are normalised";
}

TEST(TrajectoryReader, GivenAPublishedTumFileThenItReads) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = test::SharedDir() + "/data/tumvi/room1/estimates/";
  const Result<Trajectory> estimate = ReadTrajectory(folder + "xivo_estimate.tum");
  ASSERT_TRUE(estimate.ok()) << estimate.message();
  EXPECT_EQ(estimate->points.front().stamp_ns, 1520530308302287000);
  const Result<Trajectory> truth = ReadTrajectory(folder + "xivo_gt.tum");
  EXPECT_TRUE(truth.ok()) << truth.message();
}

}  // namespace
}  // namespace alidade
