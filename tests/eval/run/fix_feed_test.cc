#include "eval/run/fix_feed.h"

#include <gtest/gtest.h>

#include "gnss/base/anchor_llh.h"

namespace alidade::test {
namespace {

using Eigen::Vector3d;

RigCalibration TwoSensors(std::optional<Vector3d> first, std::optional<Vector3d> second) {
  RigCalibration rig;
  rig.fixes = {{Vector3d::Zero(), 0.5, first}, {Vector3d::Zero(), 0, second}};
  return rig;
}

TEST(FixFeedTest, GIVEN_two_sensors_on_Earth_THEN_fixes_come_in_IMU_time_and_in_one_frame) {
  const Vector3d here(47.4, 8.5, 450);
  const Vector3d there = LlhDegOf(EnuFrameAtLlh(here).ToEcef(Vector3d(1000, -2000, 30)));
  FixFeed feed(TwoSensors(here, there), false);
  using Arrival = FixFeed::Arrival;
  EXPECT_EQ(feed.Add({1'000'000'000, 0, Vector3d(1, 2, 3), Eigen::Matrix3d::Identity()}), Arrival::kTaken);
  EXPECT_EQ(feed.Add({1'400'000'000, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kTaken);
  EXPECT_EQ(feed.Add({1'400'000'000, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kTwice);
  EXPECT_EQ(feed.Add({1'400'000'000, 2, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kNoSensor);
  ASSERT_NE(feed.Next(), nullptr);
  EXPECT_EQ(feed.Next()->sensor, 1);
  EXPECT_LT((feed.Next()->p_A - Vector3d(1000, -2000, 30)).norm(), 1e-6);
  feed.Pop();
  EXPECT_EQ(feed.Next()->stamp_ns, 1'500'000'000);
  EXPECT_LT((feed.Next()->p_A - Vector3d(1, 2, 3)).norm(), 1e-9);
  EXPECT_EQ(feed.Add({1'300'000'000, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()}), Arrival::kTooLate);
}

TEST(FixFeedTest, GIVEN_frames_that_are_not_related_THEN_only_those_of_the_run_are_taken) {
  const Vector3d here(47.4, 8.5, 450);
  const PositionFix first{0, 0, Vector3d::Zero(), Eigen::Matrix3d::Identity()};
  const PositionFix second{0, 1, Vector3d::Zero(), Eigen::Matrix3d::Identity()};
  FixFeed own(TwoSensors(std::nullopt, here), false);
  EXPECT_EQ(own.Add(first), FixFeed::Arrival::kTaken);
  EXPECT_EQ(own.Add(second), FixFeed::Arrival::kUnrelated);
  EXPECT_FALSE(own.enu());
  FixFeed with_gnss(TwoSensors(std::nullopt, here), true);
  EXPECT_EQ(with_gnss.Add(first), FixFeed::Arrival::kUnrelated);
  EXPECT_EQ(with_gnss.Add(second), FixFeed::Arrival::kTaken);
  with_gnss.SetFrame(EnuFrame::At(EnuFrameAtLlh(here).ToEcef(Vector3d(0, 0, 100))));
  EXPECT_LT((with_gnss.Next()->p_A - Vector3d(0, 0, -100)).norm(), 1e-6);
}

}  // namespace
}  // namespace alidade::test
