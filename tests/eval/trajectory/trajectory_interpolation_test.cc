#include "eval/trajectory/trajectory_interpolation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/eval/trajectory/synthetic_trajectory.h"

namespace alidade::test {
namespace {

using testing::HasSubstr;

constexpr TimeNs kStepNs = 50'000'000;

Trajectory ThreeRows() {
  return MakeTrajectory(3, kSecondNs, kStepNs);
}

TEST(TrajectoryInterpolation, GIVEN_two_rows_THEN_between_them_all_parts_are_in_proportion) {
  TrajectoryPoint before, after;
  before.stamp_ns = 0;
  after.stamp_ns = 4 * kStepNs;
  after.nav.p_WB = {4, -8, 12};
  after.nav.v_WB = {0, 2, 0};
  after.bias.gyro = {0.4, 0, 0};
  after.bias.accel = {0, 0, -0.8};
  after.nav.R_WB = so3::Exp({0, 0, 3});  // a matrix between the two would be far from a rotation
  const TrajectoryPoint quarter = Interpolate(before, after, kStepNs);
  EXPECT_EQ(quarter.stamp_ns, kStepNs);
  EXPECT_TRUE(quarter.nav.p_WB.isApprox(Eigen::Vector3d(1, -2, 3)));
  EXPECT_TRUE(quarter.nav.v_WB.isApprox(Eigen::Vector3d(0, 0.5, 0)));
  EXPECT_TRUE(quarter.bias.gyro.isApprox(Eigen::Vector3d(0.1, 0, 0)));
  EXPECT_TRUE(quarter.bias.accel.isApprox(Eigen::Vector3d(0, 0, -0.2)));
  EXPECT_TRUE(quarter.nav.R_WB.isApprox(so3::Exp({0, 0, 0.75}), 1e-12));
}

TEST(InterpolateTruth, GIVEN_the_stamp_of_a_row_THEN_it_is_that_row_to_the_bit) {
  const Trajectory truth = ThreeRows();
  for (const TrajectoryPoint& row : truth.points) {
    const Result<TrajectoryPoint> point = InterpolateTruth(truth, row.stamp_ns);
    ASSERT_TRUE(point.ok()) << point.message();
    EXPECT_EQ(point->nav.p_WB, row.nav.p_WB);
    EXPECT_EQ(point->nav.R_WB, row.nav.R_WB);
  }
}

TEST(InterpolateTruth, GIVEN_a_stamp_between_rows_THEN_it_is_interpolated_between_its_neighbours) {
  const Trajectory truth = ThreeRows();
  const Result<TrajectoryPoint> point = InterpolateTruth(truth, kSecondNs + kStepNs + kStepNs / 2);
  ASSERT_TRUE(point.ok()) << point.message();
  EXPECT_TRUE(point->nav.p_WB.isApprox((truth.points[1].nav.p_WB + truth.points[2].nav.p_WB) / 2, 1e-12));
}

TEST(InterpolateTruth, GIVEN_a_stamp_that_is_not_covered_THEN_the_message_names_it_and_the_span) {
  const Trajectory truth = ThreeRows();
  for (const TimeNs stamp_ns : {kSecondNs - 1, kSecondNs + 2 * kStepNs + 1}) {
    const Result<TrajectoryPoint> point = InterpolateTruth(truth, stamp_ns);
    EXPECT_EQ(point.code(), StatusCode::kInput);
    EXPECT_THAT(point.message(), HasSubstr("truth does not cover " + FormatSeconds(stamp_ns) + " s"));
    EXPECT_THAT(point.message(), HasSubstr("it spans " + FormatSeconds(kSecondNs) + " s to " +
                                           FormatSeconds(kSecondNs + 2 * kStepNs) + " s"));
  }
  EXPECT_THAT(InterpolateTruth(Trajectory(), kSecondNs).message(), HasSubstr("it is empty"));
}

TEST(InterpolateTruth, GIVEN_a_gap_of_more_than_a_tenth_of_a_second_THEN_it_is_not_bridged) {
  EXPECT_TRUE(InterpolateTruth(MakeTrajectory(2, kSecondNs, 100'000'000), kSecondNs + 1).ok());
  const Result<TrajectoryPoint> point =
      InterpolateTruth(MakeTrajectory(2, kSecondNs, 100'000'001), kSecondNs + 1);
  EXPECT_EQ(point.code(), StatusCode::kInput);
  EXPECT_THAT(point.message(), HasSubstr("truth has a gap around"));
}

}  // namespace
}  // namespace alidade::test
