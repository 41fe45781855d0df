#include "eval/peers/peer_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/lie.h"
#include "eval/compare/external_times.h"
#include "eval/trajectory/external_trajectory.h"
#include "tests/support/read_file.h"
#include "tests/support/temporary_folder.h"

namespace alidade {
namespace {

using testing::ElementsAre;

PeerRun MakeRun() {
  PeerRun run;
  run.trajectory.has_velocity = run.trajectory.has_bias = run.trajectory.has_covariance = true;
  for (int i = 0; i < 3; ++i) {
    TrajectoryPoint point;
    point.stamp_ns = 1403715273262142976 + i * TimeNs{50'000'000};
    point.nav = {so3::Exp(Eigen::Vector3d(0.3, -0.2, 0.1 * i)), Eigen::Vector3d(1, 2.5, i),
                 Eigen::Vector3d(0.1, 0, 1.0 / 3)};
    point.bias = {Eigen::Vector3d(1e-3, 0, 0), Eigen::Vector3d(0, 1e-2, 0)};
    point.covariance = (1.0 + i) * Matrix6d::Identity();
    point.covariance(0, 5) = point.covariance(5, 0) = 0.25;
    run.trajectory.points.push_back(point);
    run.times.push_back({0.5 * i, 2.0 + i});
  }
  return run;
}

// What a driver writes is what a comparison reads.
TEST(WritePeerRun, GivenStatesThenAComparisonReadsThemWithCovarianceAndTimes) {
  const test::TemporaryFolder folder;
  const PeerRun run = MakeRun();
  ASSERT_TRUE(WritePeerRun(run, folder.path()).ok());
  ExternalContext context;
  const Result<Trajectory> read = ReadExternalTrajectory(folder.File("trajectory.csv"), &context);
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_TRUE(read->has_covariance && read->has_velocity && read->has_bias);
  ASSERT_EQ(read->points.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const TrajectoryPoint& written = run.trajectory.points[i];
    EXPECT_EQ(read->points[i].stamp_ns, written.stamp_ns);
    EXPECT_EQ(read->points[i].nav.p_WB, written.nav.p_WB);
    EXPECT_LT((read->points[i].nav.R_WB - written.nav.R_WB).norm(), 1e-12);
    EXPECT_EQ(read->points[i].covariance, written.covariance);
  }
  const Result<ExternalTimes> times = ReadExternalTimes(folder.File("timing.csv"));
  ASSERT_TRUE(times.ok()) << times.message();
  EXPECT_THAT(times->frontend_ms, ElementsAre(0, 0.5, 1));
  EXPECT_THAT(times->backend_ms, ElementsAre(2, 3, 4));
}

TEST(WritePeerRun, GivenNoCovarianceThenNoneIsRead) {
  const test::TemporaryFolder folder;
  PeerRun run = MakeRun();
  run.trajectory.has_covariance = false;
  ASSERT_TRUE(WritePeerRun(run, folder.path()).ok());
  ExternalContext context;
  const Result<Trajectory> read = ReadExternalTrajectory(folder.File("trajectory.csv"), &context);
  ASSERT_TRUE(read.ok()) << read.message();
  EXPECT_FALSE(read->has_covariance);
}

TEST(WritePeerRun, ARunWithoutAStateIsAFault) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(WritePeerRun({}, folder.path()).code(), StatusCode::kDiverged);
}

Status Accept(const std::vector<std::string>& arguments) {
  return arguments == std::vector<std::string>{"--a=1", "--b=2"} ? Status::Ok()
                                                                 : Status::Usage("other arguments");
}

TEST(RunDriver, HandsTheArgumentsOnAndReportsTheError) {
  std::string name = "program", first = "--a=1", second = "--b=2";
  char* arguments[] = {name.data(), first.data(), second.data()};
  EXPECT_EQ(RunDriver("driver", 3, arguments, Accept), 0);
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunDriver("driver", 2, arguments, Accept), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "driver: other arguments\n");
}

}  // namespace
}  // namespace alidade
