#include "core/scene_depth.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

TEST(SceneDepthTest, IsTheMedianOfTheLatestTracks) {
  SceneDepth depth;
  for (int i = 1; i <= 9; ++i) {
    depth.Add(i);
    EXPECT_EQ(depth.Metres(), kRoomDepth) << "few tracks are no scenery";
  }
  depth.Add(1000);
  EXPECT_DOUBLE_EQ(depth.Metres(), 6);
  for (int i = 0; i < 64; ++i) {
    depth.Add(20);
  }
  EXPECT_DOUBLE_EQ(depth.Metres(), 20);
  depth.Clear();
  EXPECT_EQ(depth.Metres(), kRoomDepth);
}

}  // namespace
}  // namespace alidade
