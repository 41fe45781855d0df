#include "eval/metrics/association.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "eval/metrics/state_pair.h"
#include "tests/eval/trajectory/synthetic_trajectory.h"

namespace alidade {
namespace {

using test::MakeTrajectory;
using testing::HasSubstr;

Trajectory AtStamps(const std::vector<TimeNs>& stamps) {
  Trajectory trajectory;
  for (const TimeNs stamp : stamps) {
    TrajectoryPoint point;
    point.stamp_ns = stamp;
    point.nav.p_WB.x() = static_cast<double>(stamp);
    trajectory.points.push_back(point);
  }
  return trajectory;
}

std::vector<std::pair<TimeNs, TimeNs>> Stamps(const Result<std::vector<StatePair>>& pairs) {
  std::vector<std::pair<TimeNs, TimeNs>> stamps;
  for (const StatePair& pair : *pairs) {
    stamps.emplace_back(pair.truth.stamp_ns, pair.estimate.stamp_ns);
  }
  return stamps;
}

using Pairs = std::vector<std::pair<TimeNs, TimeNs>>;

TEST(AssociateNearest, TakesTheNearestRowOnEitherSide) {
  const auto pairs =
      Associate(AtStamps({0, 100, 200, 300}), AtStamps({-10, 130, 180, 310}), {.max_dt_s = 40e-9});
  ASSERT_TRUE(pairs.ok()) << pairs.message();
  EXPECT_EQ(Stamps(pairs), (Pairs{{0, -10}, {100, 130}, {200, 180}, {300, 310}}));
}

TEST(AssociateNearest, ToleranceIsInclusiveToTheNanosecond) {
  const Trajectory truth = AtStamps({0, 1000, 2000, 3000});
  EXPECT_EQ(Associate(truth, AtStamps({100, 1100, 2101, 3100}), {.max_dt_s = 100e-9})->size(), 3u);
}

TEST(AssociateNearest, ToleranceOfOneMillisecondKeepsUnixStampsExact) {
  const TimeNs unix_ns = 1'520'530'308'302'287'001;
  const TimeNs ms = 1'000'000;
  const Trajectory truth = AtStamps({unix_ns, unix_ns + 10 * ms, unix_ns + 20 * ms, unix_ns + 30 * ms});
  const Trajectory estimate =
      AtStamps({unix_ns + ms, unix_ns + 11 * ms + 1, unix_ns + 21 * ms, unix_ns + 29 * ms});
  EXPECT_EQ(Associate(truth, estimate, {.max_dt_s = 1e-3})->size(), 3u);
}

TEST(AssociateNearest, ATruthRowServesOnlyItsNearestEstimate) {
  const auto pairs = Associate(AtStamps({0, 100, 200}), AtStamps({-4, 3, 96, 110, 200}), {.max_dt_s = 30e-9});
  EXPECT_EQ(Stamps(pairs), (Pairs{{0, 3}, {100, 96}, {200, 200}}));
}

TEST(AssociateNearest, PairsAreOneToOneOrderedAndWithinToleranceForRandomStamps) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::set<TimeNs> truth_stamps, estimate_stamps;
    while (truth_stamps.size() < 40) truth_stamps.insert(static_cast<TimeNs>(random() % 1000));
    while (estimate_stamps.size() < 60) estimate_stamps.insert(static_cast<TimeNs>(random() % 1000));
    const auto pairs =
        Associate(AtStamps({truth_stamps.begin(), truth_stamps.end()}),
                  AtStamps({estimate_stamps.begin(), estimate_stamps.end()}), {.max_dt_s = 50e-9});
    ASSERT_TRUE(pairs.ok()) << pairs.message();
    for (std::size_t i = 0; i < pairs->size(); ++i) {
      const StatePair& pair = (*pairs)[i];
      EXPECT_LE(std::abs(pair.truth.stamp_ns - pair.estimate.stamp_ns), 50);
      if (i > 0) {
        EXPECT_GT(pair.truth.stamp_ns, (*pairs)[i - 1].truth.stamp_ns);
        EXPECT_GT(pair.estimate.stamp_ns, (*pairs)[i - 1].estimate.stamp_ns);
      }
    }
  }
}

TEST(AssociateInterpolated, FollowsAConstantTwistExactly) {
  Trajectory truth = MakeTrajectory(20);
  const Eigen::Vector3d rate(0.3, -0.8, 1.1), velocity(1, 2, -0.5);
  const auto state_at = [&](TimeNs stamp) {
    const double t = static_cast<double>(stamp) * kNsToSeconds;
    return NavState{so3::Exp({0.1, 0.2, 0.3}) * so3::Exp(rate * t), velocity * t, velocity * (2 + t)};
  };
  for (TrajectoryPoint& point : truth.points) {
    point.nav = state_at(point.stamp_ns);
    point.bias.gyro.x() = static_cast<double>(point.stamp_ns) * kNsToSeconds;
  }
  const Trajectory estimate = MakeTrajectory(15, 1'033'000'000);
  const auto pairs = Associate(truth, estimate, {.interpolate = true, .max_gap_s = 0.1});
  ASSERT_TRUE(pairs.ok()) << pairs.message();
  ASSERT_EQ(pairs->size(), 15u);
  for (const StatePair& pair : *pairs) {
    const NavState expected = state_at(pair.estimate.stamp_ns);
    EXPECT_EQ(pair.truth.stamp_ns, pair.estimate.stamp_ns);
    EXPECT_LT((pair.truth.nav.p_WB - expected.p_WB).norm(), 1e-12);
    EXPECT_LT((pair.truth.nav.v_WB - expected.v_WB).norm(), 1e-12);
    EXPECT_LT((pair.truth.nav.R_WB - expected.R_WB).norm(), 1e-12);
    EXPECT_NEAR(pair.truth.bias.gyro.x(), static_cast<double>(pair.estimate.stamp_ns) * kNsToSeconds, 1e-12);
  }
}

TEST(AssociateInterpolated, NeverCrossesAGapNorExtrapolates) {
  const Trajectory truth = AtStamps({0, 100, 200, 1200, 1300});
  const auto pairs = Associate(truth, AtStamps({-1, 0, 50, 150, 200, 250, 700, 1199, 1250, 1300, 1301}),
                               {.interpolate = true, .max_gap_s = 100e-9});
  EXPECT_EQ(Stamps(pairs), (Pairs{{0, 0}, {50, 50}, {150, 150}, {200, 200}, {1250, 1250}, {1300, 1300}}));
  for (const StatePair& pair : *pairs) {
    EXPECT_DOUBLE_EQ(pair.truth.nav.p_WB.x(), static_cast<double>(pair.estimate.stamp_ns));
  }
}

TEST(AssociateFailure, NamesRangesCountAndTheToleranceThatWouldMatch) {
  const Trajectory truth = MakeTrajectory(50);
  const Trajectory estimate = MakeTrajectory(40, 1'030'000'000);
  const auto pairs = Associate(truth, estimate, {.max_dt_s = 0.01});
  ASSERT_FALSE(pairs.ok());
  EXPECT_EQ(pairs.code(), StatusCode::kInput);
  EXPECT_THAT(pairs.message(), HasSubstr("only 0 pairs"));
  EXPECT_THAT(pairs.message(), HasSubstr("within a max_dt of 0.01 s"));
  EXPECT_THAT(pairs.message(), HasSubstr("truth 1.000000000 to 5.900000000 s (50 rows)"));
  EXPECT_THAT(pairs.message(), HasSubstr("estimate 1.030000000 to 4.930000000 s (40 rows)"));
  EXPECT_THAT(pairs.message(), HasSubstr("a max_dt of 0.03003 s"));
  EXPECT_GE(Associate(truth, estimate, {.max_dt_s = 0.03003})->size(), 21u);
}

TEST(AssociateFailure, SuspectsNanosecondsReadAsSeconds) {
  // GIVEN an estimate whose seconds were taken for nanoseconds
  const Trajectory estimate = MakeTrajectory(500, 14, 1);
  const auto pairs = Associate(MakeTrajectory(500, 14'000'000'000, 1'000'000'000), estimate, {});
  ASSERT_FALSE(pairs.ok());
  EXPECT_THAT(pairs.message(), HasSubstr("nanoseconds and seconds mixed up?"));
  EXPECT_THAT(pairs.message(), HasSubstr("the truth lasts about 1e+09 times"));
}

TEST(AssociateFailure, SuspectsAConstantOffset) {
  const auto pairs =
      Associate(MakeTrajectory(50, 315'965'000'000'000'000), MakeTrajectory(50, 200'000'000'000), {});
  ASSERT_FALSE(pairs.ok());
  EXPECT_THAT(pairs.message(),
              HasSubstr("do not overlap: the truth starts 3.15965e+08 s after the estimate"));
  EXPECT_THAT(pairs.message(), HasSubstr("constant offset"));
}

TEST(AssociateFailure, AShortPieceOfTheLogIsNotTakenForAnotherUnit) {
  const auto pairs = Associate(MakeTrajectory(5000), MakeTrajectory(5, 9'000'000'000'000), {});
  ASSERT_FALSE(pairs.ok());
  EXPECT_THAT(pairs.message(), HasSubstr("constant offset"));
}

TEST(AssociateFailure, NamesTheGapThatForbidsInterpolation) {
  const auto pairs = Associate(MakeTrajectory(50), MakeTrajectory(40, 1'030'000'000),
                               {.interpolate = true, .max_gap_s = 0.05});
  ASSERT_FALSE(pairs.ok());
  EXPECT_THAT(pairs.message(), HasSubstr("0.1 s apart (median): a longer max_gap"));
}

TEST(AssociateFailure, RefusesTooFewRowsAndSenselessTolerances) {
  EXPECT_THAT(Associate(AtStamps({}), AtStamps({1, 2, 3}), {}).message(), HasSubstr("the truth has 0 rows"));
  EXPECT_THAT(Associate(AtStamps({1, 2, 3}), AtStamps({1, 2}), {}).message(),
              HasSubstr("the estimate has 2 rows"));
  for (const double senseless : {-1.0, std::numeric_limits<double>::quiet_NaN(), 1e12}) {
    const auto pairs = Associate(AtStamps({1, 2, 3}), AtStamps({1, 2, 3}), {.max_dt_s = senseless});
    EXPECT_EQ(pairs.code(), StatusCode::kUsage) << senseless;
    EXPECT_THAT(pairs.message(), HasSubstr("max_dt: found "));
  }
}

}  // namespace
}  // namespace alidade
