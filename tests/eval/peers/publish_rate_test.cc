#include "eval/peers/publish_rate.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

int HandedOver(double camera_hz, double limit_hz, int images) {
  PublishRate rate(limit_hz);
  int count = 0;
  for (int i = 0; i < images; ++i) {
    count += rate.Take(i / camera_hz).value_or(false) ? 1 : 0;
  }
  return count;
}

TEST(PublishRate, TheFirstImageStartsTheClock) {
  PublishRate rate(10);
  EXPECT_FALSE(rate.Take(5).has_value());
  EXPECT_TRUE(rate.Take(5.05).has_value());
}

TEST(PublishRate, GivenAFasterCameraThenHalfOfItsImagesAreHandedOver) {
  EXPECT_NEAR(HandedOver(20, 10, 201), 100, 6);
}

TEST(PublishRate, GivenASlowerCameraThenAllButTheFirstAreHandedOver) {
  EXPECT_EQ(HandedOver(8, 10, 81), 80);
}

}  // namespace
}  // namespace alidade
