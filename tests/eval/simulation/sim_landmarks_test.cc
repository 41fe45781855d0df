#include "eval/simulation/sim_landmarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "eval/simulation/sim_trajectory.h"
#include "tests/support/steps.h"

namespace alidade {
namespace {

TEST(SimLandmarksTest, ARoomHasItsLandmarksOnAllSixWalls) {
  SimulatorConfig config;
  config.landmark_layout = SimLandmarkLayout::kRoom;
  config.landmark_min_distance_m = 0.4;
  config.landmark_count = 2000;
  config.room_margin_m << 2, 1.5, 1;
  config.room_depth_m = 0.3;
  config.duration_s = 20;
  config.path_m = 27;  // one lap and a little more
  const auto trajectory = MakeSimTrajectory(config);
  const std::vector<Eigen::Vector3d> landmarks = MakeLandmarks(config, *trajectory, 1).value();
  ASSERT_EQ(landmarks.size(), 2000u);
  const Eigen::Vector3d wall(5 + 2, 2.5 + 1.5, 0.5 + 1);
  std::array<int, 6> count = {};
  for (const Eigen::Vector3d& p_W : landmarks) {
    int walls = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // The path is sampled every 4 cm: its bounding box is that much too small at most.
      ASSERT_LE(std::abs(p_W[axis]), wall[axis] + 1e-3);
      if (std::abs(p_W[axis]) > wall[axis] - 0.3 - 0.04) {
        ++walls;
        ++count[static_cast<std::size_t>(2 * axis + (p_W[axis] > 0 ? 1 : 0))];
      }
    }
    ASSERT_GE(walls, 1) << p_W.transpose();
    for (const double t : test::Steps(0, 20, 0.05)) {
      ASSERT_GT((trajectory->At(t).nav.p_WB - p_W).norm(), 0.4 - 0.04);
    }
  }
  // Floor and ceiling have 112 m^2 each, the walls 24 and 42.
  EXPECT_NEAR(count[4] + count[5], 2000 * 224.0 / 356.0, 200);
  EXPECT_GT(*std::min_element(count.begin(), count.end()), 80);
}

TEST(SimLandmarksTest, ARoomWithoutRoomIsAConfigurationError) {
  SimulatorConfig config;
  config.landmark_layout = SimLandmarkLayout::kRoom;
  config.landmark_min_distance_m = 50;
  config.landmark_count = 20;
  const Result<std::vector<Eigen::Vector3d>> landmarks = MakeLandmarks(config, *MakeSimTrajectory(config), 1);
  ASSERT_FALSE(landmarks.ok());
  EXPECT_EQ(landmarks.code(), StatusCode::kConfig);
  EXPECT_NE(landmarks.message().find("room_margin_m"), std::string::npos);
}

// GIVEN an even density WHEN the space around the path is filled THEN its parts hold as many landmarks as
// their volumes, found by another grid, ask for.
TEST(SimLandmarksTest, AVolumeIsEvenlyDense) {
  SimulatorConfig config;
  config.landmark_layout = SimLandmarkLayout::kVolume;
  config.landmark_density_per_m3 = 1;
  config.landmark_min_distance_m = 2;
  config.landmark_max_distance_m = 6;
  config.duration_s = 20;
  config.path_m = 27;
  const auto trajectory = MakeSimTrajectory(config);
  const std::vector<Eigen::Vector3d> landmarks = MakeLandmarks(config, *trajectory, 2).value();
  std::vector<Eigen::Vector3d> path;
  for (const double t : test::Steps(0, 20.05, 0.1)) {
    path.push_back(trajectory->At(t).nav.p_WB);
  }
  const auto distance_m = [&path](const Eigen::Vector3d& p_W) {
    double nearest = 1e9;
    for (const Eigen::Vector3d& point : path) {
      nearest = std::min(nearest, (point - p_W).norm());
    }
    return nearest;
  };
  constexpr double kStep = 0.5;
  double volume[2] = {0, 0};  // beyond and within 4 m of the path, m^3
  for (const double x : test::Steps(-11.25, 11.5, kStep)) {
    for (const double y : test::Steps(-8.75, 9, kStep)) {
      for (const double z : test::Steps(-6.75, 7, kStep)) {
        const double d = distance_m({x, y, z});
        volume[d < 4 ? 1 : 0] += d >= 2 && d <= 6 ? kStep * kStep * kStep : 0;
      }
    }
  }
  double count[2] = {0, 0};
  for (const Eigen::Vector3d& p_W : landmarks) {
    const double d = distance_m(p_W);
    ASSERT_GT(d, 1.9);
    ASSERT_LT(d, 6.1);
    count[d < 4 ? 1 : 0] += 1;
  }
  for (int part = 0; part < 2; ++part) {
    ASSERT_GT(volume[part], 300);
    EXPECT_NEAR(count[part], volume[part], 4 * std::sqrt(volume[part]) + 0.03 * volume[part]);
  }
}

TEST(SimLandmarksTest, ADensityBeyondReasonIsAConfigurationError) {
  SimulatorConfig config;
  config.landmark_layout = SimLandmarkLayout::kVolume;
  for (const double density : {1e5, 1e-5}) {
    config.landmark_density_per_m3 = density;
    const Result<std::vector<Eigen::Vector3d>> landmarks =
        MakeLandmarks(config, *MakeSimTrajectory(config), 1);
    ASSERT_EQ(landmarks.code(), StatusCode::kConfig);
    EXPECT_NE(landmarks.message().find("landmark_density_per_m3"), std::string::npos);
  }
}

}  // namespace
}  // namespace alidade
