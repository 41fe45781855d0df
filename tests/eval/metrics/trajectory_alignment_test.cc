#include "eval/metrics/trajectory_alignment.h"

#include <gtest/gtest.h>

#include <random>

#include "eval/metrics/metrics.h"
#include "eval/metrics/nees.h"
#include "eval/metrics/state_pair.h"
#include "tests/eval/trajectory/synthetic_trajectory.h"

namespace alidade {
namespace {

using test::DrawRotation;
using test::DrawVector;
using test::PerfectPairs;

/// The transform class that each alignment may undo, drawn at random.
AlignmentTransform DrawTransform(TrajectoryAlignment alignment, std::mt19937_64& random) {
  AlignmentTransform transform;
  if (alignment != TrajectoryAlignment::kNone) {
    transform.translation = DrawVector(random, 20);
  }
  if (alignment == TrajectoryAlignment::kPosYaw) {
    transform.rotation = so3::Exp({0, 0, std::uniform_real_distribution<double>(-3.1, 3.1)(random)});
  } else if (alignment == TrajectoryAlignment::kSe3 || alignment == TrajectoryAlignment::kSim3) {
    transform.rotation = DrawRotation(random);
  }
  if (alignment == TrajectoryAlignment::kSim3) {
    transform.scale = std::uniform_real_distribution<double>(0.2, 4)(random);
  }
  return transform;
}

/// Estimates such that `transform` maps them onto the truth.
std::vector<StatePair> MovedAway(const std::vector<StatePair>& pairs, const AlignmentTransform& transform) {
  std::vector<StatePair> moved = pairs;
  for (StatePair& pair : moved) {
    const NavState truth = pair.truth.nav;
    NavState& nav = pair.estimate.nav;
    nav.R_WB = transform.rotation.transpose() * truth.R_WB;
    nav.p_WB = transform.rotation.transpose() * (truth.p_WB - transform.translation) / transform.scale;
    nav.v_WB = transform.rotation.transpose() * truth.v_WB / transform.scale;
  }
  return moved;
}

class EveryAlignment : public testing::TestWithParam<TrajectoryAlignment> {};

TEST_P(EveryAlignment, RecoversAKnownTransformAndLeavesNoError) {
  std::mt19937_64 random(7);
  const std::vector<StatePair> perfect = PerfectPairs(200);
  for (int trial = 0; trial < 25; ++trial) {
    const AlignmentTransform expected = DrawTransform(GetParam(), random);
    const std::vector<StatePair> pairs = MovedAway(perfect, expected);
    const AlignmentTransform found = Align(pairs, GetParam());
    EXPECT_TRUE(found.rotation.isApprox(expected.rotation, 1e-9)) << found.rotation;
    EXPECT_TRUE((found.translation - expected.translation).norm() < 1e-8) << found.translation.transpose();
    EXPECT_NEAR(found.scale, expected.scale, 1e-9);

    const std::vector<StatePair> aligned = ApplyAlignment(pairs, found);
    const AteResult ate = ComputeAte(aligned);
    EXPECT_LT(ate.pos_m, 1e-8);
    EXPECT_LT(ate.ori_deg, 1e-5);
    for (const StatePair& pair : aligned) {
      EXPECT_LT((pair.truth.nav.v_WB - pair.estimate.nav.v_WB).norm(), 1e-8);
    }
  }
}

TEST_P(EveryAlignment, IsAMinimumOfThePositionErrorAmongItsOwnTransforms) {
  std::mt19937_64 random(11);
  std::vector<StatePair> pairs = MovedAway(PerfectPairs(100), DrawTransform(GetParam(), random));
  for (StatePair& pair : pairs) {
    pair.estimate.nav.p_WB += DrawVector(random, 0.3);
  }
  const AlignmentTransform best = Align(pairs, GetParam());
  const double least = ComputeAte(ApplyAlignment(pairs, best)).pos_m;
  for (int trial = 0; trial < 50 && GetParam() != TrajectoryAlignment::kNone; ++trial) {
    AlignmentTransform other = best;
    other.translation += DrawVector(random, 0.05);
    if (GetParam() == TrajectoryAlignment::kPosYaw) {
      other.rotation = so3::Exp({0, 0, 0.02 * (trial - 25)}) * best.rotation;
    } else if (GetParam() != TrajectoryAlignment::kPos) {
      other.rotation = so3::Exp(DrawVector(random, 0.02)) * best.rotation;
    }
    if (GetParam() == TrajectoryAlignment::kSim3) {
      other.scale *= 1 + 0.002 * (trial - 25);
    }
    EXPECT_GE(ComputeAte(ApplyAlignment(pairs, other)).pos_m, least);
  }
}

TEST_P(EveryAlignment, StaysFiniteAndRigidOnDegenerateClouds) {
  for (const double step : {0.0, 0.1}) {
    std::vector<StatePair> pairs(10);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      pairs[i].truth.nav.p_WB = {1 + step * static_cast<double>(i), 2, 3};
      pairs[i].estimate.nav.p_WB = {4, 5 - step * static_cast<double>(i), 6};
    }
    const AlignmentTransform transform = Align(pairs, GetParam());
    EXPECT_TRUE((transform.rotation * transform.rotation.transpose()).isIdentity(1e-9));
    EXPECT_NEAR(transform.rotation.determinant(), 1, 1e-9);
    EXPECT_TRUE(transform.translation.allFinite());
    EXPECT_NEAR(transform.scale, 1, 1e-9);
  }
  EXPECT_TRUE(Align({}, GetParam()).rotation.isIdentity());
}

TEST_P(EveryAlignment, NameReadsBack) {
  EXPECT_EQ(ParseTrajectoryAlignment(ToString(GetParam())), GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, EveryAlignment,
                         testing::Values(TrajectoryAlignment::kNone, TrajectoryAlignment::kPos,
                                         TrajectoryAlignment::kPosYaw, TrajectoryAlignment::kSe3,
                                         TrajectoryAlignment::kSim3),
                         [](const auto& test) { return std::string(ToString(test.param)); });

TEST(TrajectoryAlignment, UnknownNameIsNoAlignment) {
  EXPECT_EQ(ParseTrajectoryAlignment("SE3"), std::nullopt);
  EXPECT_EQ(ParseTrajectoryAlignment(""), std::nullopt);
}

TEST(TrajectoryAlignment, YawAlignmentKeepsATiltVisible) {
  const double tilt_rad = 0.05;
  AlignmentTransform tilt;
  tilt.rotation = so3::Exp({tilt_rad, 0, 0});
  const std::vector<StatePair> pairs = MovedAway(PerfectPairs(200), tilt);
  const double degrees = tilt_rad * 180 / M_PI;
  EXPECT_NEAR(ComputeAte(ApplyAlignment(pairs, Align(pairs, TrajectoryAlignment::kPosYaw))).ori_deg, degrees,
              0.1 * degrees);
  EXPECT_LT(ComputeAte(ApplyAlignment(pairs, Align(pairs, TrajectoryAlignment::kSe3))).ori_deg, 1e-5);
}

TEST(TrajectoryAlignment, NeverMirrors) {
  std::vector<StatePair> pairs = PerfectPairs(100);
  for (StatePair& pair : pairs) {
    pair.estimate.nav.p_WB.y() *= -1;
  }
  EXPECT_NEAR(Align(pairs, TrajectoryAlignment::kSe3).rotation.determinant(), 1, 1e-9);
  EXPECT_NEAR(Align(pairs, TrajectoryAlignment::kSim3).rotation.determinant(), 1, 1e-9);
}

TEST(TrajectoryAlignment, CovarianceTurnsWithTheWorldSoThatNeesOfAConsistentlyMovedPairIsUnchanged) {
  std::mt19937_64 random(5);
  std::vector<StatePair> pairs = PerfectPairs(20);
  for (StatePair& pair : pairs) {
    const Matrix6d root =
        Matrix6d::NullaryExpr([&] { return std::normal_distribution<double>(0, 0.1)(random); });
    pair.estimate.covariance = root * root.transpose() + 1e-4 * Matrix6d::Identity();
    pair.estimate.nav.p_WB += DrawVector(random, 0.1);
    pair.estimate.nav.R_WB *= so3::Exp(DrawVector(random, 0.1));
  }
  const NeesResult before = ComputeNees(pairs);
  const AlignmentTransform transform = DrawTransform(TrajectoryAlignment::kSim3, random);
  std::vector<StatePair> moved = ApplyAlignment(pairs, transform);
  for (StatePair& pair : moved) {  // the truth moves along
    pair.truth.nav.R_WB = (transform.rotation * pair.truth.nav.R_WB).eval();
    pair.truth.nav.p_WB =
        (transform.scale * (transform.rotation * pair.truth.nav.p_WB) + transform.translation).eval();
  }
  const NeesResult after = ComputeNees(moved);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_NEAR(after.pose[i], before.pose[i], 1e-6 * before.pose[i]);
  }
}

}  // namespace
}  // namespace alidade
