#include "eval/metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "eval/metrics/state_pair.h"
#include "eval/metrics/trajectory_alignment.h"
#include "tests/eval/trajectory/synthetic_trajectory.h"

namespace alidade {
namespace {

using test::PerfectPairs;

/// `rows` pairs on a straight line, `step_m` apart, the estimate scaled by `scale`.
std::vector<StatePair> StraightLine(int rows, double step_m, double scale) {
  std::vector<StatePair> pairs(static_cast<std::size_t>(rows));
  const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -2) / 3;
  for (int i = 0; i < rows; ++i) {
    StatePair& pair = pairs[static_cast<std::size_t>(i)];
    pair.truth.nav.p_WB = direction * (step_m * i);
    pair.estimate.nav.p_WB = scale * pair.truth.nav.p_WB;
  }
  return pairs;
}

TEST(Ate, IsTheRootMeanSquareAndTheMaximum) {
  std::vector<StatePair> pairs = PerfectPairs(4);
  pairs[0].estimate.nav.p_WB += Eigen::Vector3d(3, 0, 4);
  pairs[2].estimate.nav.p_WB += Eigen::Vector3d(0, -1, 0);
  pairs[1].estimate.nav.R_WB *= so3::Exp({0, 0.2, 0});
  pairs[3].estimate.nav.R_WB = so3::Exp({0, 0, -0.1}) * pairs[3].estimate.nav.R_WB.eval();
  const AteResult ate = ComputeAte(pairs);
  EXPECT_NEAR(ate.pos_m, std::sqrt(26.0 / 4), 1e-12);
  EXPECT_NEAR(ate.pos_max_m, 5, 1e-12);
  EXPECT_NEAR(ate.ori_deg, std::sqrt((0.04 + 0.01) / 4) * 180 / M_PI, 1e-9);
}

TEST(Ate, OfNoPairsIsNotANumber) {
  EXPECT_TRUE(std::isnan(ComputeAte({}).pos_m));
  EXPECT_EQ(PathLength({}), 0);
}

TEST(PathLength, SumsTheTruthAndNotTheEstimate) {
  EXPECT_NEAR(PathLength(StraightLine(101, 0.5, 7)), 50, 1e-9);
}

TEST(Rpe, OfAScaleDriftIsTheDriftTimesTheDistance) {
  const std::vector<StatePair> pairs = StraightLine(101, 0.5, 1.02);
  const std::vector<RpeResult> results = ComputeRpe(pairs, {5, 20});
  ASSERT_EQ(results.size(), 2u);
  EXPECT_NEAR(results[0].pos_rmse_m, 0.1, 1e-9);
  EXPECT_NEAR(results[1].pos_rmse_m, 0.4, 1e-9);
  EXPECT_EQ(results[0].count, 91);
  EXPECT_EQ(results[1].count, 61);
  EXPECT_EQ(results[0].pos_errors_m.size(), 91u);
  EXPECT_NEAR(results[0].ori_rmse_deg, 0, 1e-9);
}

TEST(Rpe, OfAYawDriftIsTheDriftTimesTheDistance) {
  std::vector<StatePair> pairs = StraightLine(101, 0.5, 1);
  const double rate_rad_per_m = 0.001;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].estimate.nav.R_WB = so3::Exp({0, 0, rate_rad_per_m * 0.5 * static_cast<double>(i)});
  }
  EXPECT_NEAR(ComputeRpe(pairs, {10})[0].ori_rmse_deg, 10 * rate_rad_per_m * 180 / M_PI, 1e-9);
}

TEST(Rpe, IsMeasuredInTheFrameOfTheFirstPose) {
  // GIVEN an estimate that differs from the truth by one rigid motion, WHEN nothing is aligned, THEN RPE is
  // zero.
  std::vector<StatePair> pairs = PerfectPairs(300);
  AlignmentTransform motion;
  motion.rotation = so3::Exp({0.4, -1.0, 2.0});
  motion.translation = {10, -20, 30};
  for (const RpeResult& rpe : ComputeRpe(ApplyAlignment(pairs, motion), {1, 5, 10})) {
    EXPECT_GT(rpe.count, 50);
    EXPECT_LT(rpe.pos_rmse_m, 1e-9);
    EXPECT_LT(rpe.ori_rmse_deg, 1e-5);
  }
  // A first pose that is turned alone swings the whole sub-trajectory.
  std::vector<StatePair> line = StraightLine(2, 10, 1);
  line[0].estimate.nav.R_WB = so3::Exp(Eigen::Vector3d(2, -1, 0).normalized() * 0.01);
  EXPECT_NEAR(ComputeRpe(line, {10})[0].pos_rmse_m, 2 * 10 * std::sin(0.005), 1e-9);
}

TEST(Rpe, EndsAtThePairNearestToTheDistance) {
  EXPECT_NEAR(ComputeRpe(StraightLine(100, 1, 2), {20.4})[0].pos_rmse_m, 20, 1e-9);
  EXPECT_NEAR(ComputeRpe(StraightLine(100, 1, 2), {20.6})[0].pos_rmse_m, 21, 1e-9);
}

// GIVEN a path that ends before the distance THEN it gives no pair, although its whole length is within 10 %
// of it, unless half a step is all that is missing.
TEST(Rpe, OfAPathThatEndsBeforeTheDistanceIsNotANumber) {
  EXPECT_EQ(ComputeRpe(StraightLine(77, 0.1, 1.1), {8})[0].count, 0);  // 7.6 m
  EXPECT_EQ(ComputeRpe(StraightLine(77, 0.1, 1.1), {7.64})[0].count, 1);
  EXPECT_EQ(ComputeRpe(StraightLine(77, 0.1, 1.1), {7.66})[0].count, 0);
}

TEST(Rpe, OfADistanceThatThePairsCannotResolveOrReachIsNotANumber) {
  const std::vector<double> distances = {0.3, 100, 0, -1, NAN, INFINITY};
  for (const RpeResult& rpe : ComputeRpe(StraightLine(50, 1, 1.1), distances)) {
    EXPECT_EQ(rpe.count, 0) << rpe.distance_m;
    EXPECT_TRUE(std::isnan(rpe.pos_rmse_m));
    EXPECT_TRUE(std::isnan(rpe.ori_rmse_deg));
  }
  EXPECT_EQ(ComputeRpe({}, {1})[0].count, 0);
}

}  // namespace
}  // namespace alidade
