#include "eval/sim_landmarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "eval/sim_trajectory.h"

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
    for (double t = 0; t < 20; t += 0.05) {
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

}  // namespace
}  // namespace alidade
