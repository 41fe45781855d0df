#include "gnss/alignment/fix_aligner.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/random.h"
#include "tests/gnss/alignment/kernel_choice.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

/// A body that walks a circle in the frame of the fixes; the local world is turned and shifted against it.
struct FixWalk {
  double radius_m = 15;
  double speed_mps = 3;
  double yaw_rad = 0.7;  ///< R_NW
  Vector3d p_NW = Vector3d(30, -20, 5);
  Vector3d dv_W = Vector3d::Zero();  ///< by which the estimate's velocity is off
  double velocity_std_mps = 0;       ///< in its own covariance
  double std_m = 1;                  ///< of the fixes
  double wrong_rate = 0;
  unsigned seed = 1;
  FixSensor sensor = {Vector3d(0.3, -0.2, 0.9), 0, std::nullopt};

  [[nodiscard]] NavState Global(double t) const {
    const double phase = speed_mps / radius_m * t;
    return {Eigen::AngleAxisd(phase, Vector3d::UnitZ()).toRotationMatrix(),
            radius_m * Vector3d(std::cos(phase), std::sin(phase), 0),
            speed_mps * Vector3d(-std::sin(phase), std::cos(phase), 0)};
  }
  [[nodiscard]] NavEstimate Local(double t) const {
    const Eigen::Matrix3d R_WN = Eigen::AngleAxisd(-yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
    const NavState global = Global(t);
    NavEstimate estimate;
    estimate.stamp_ns = SecondsToNs(t);
    estimate.nav = {R_WN * global.R_WB, R_WN * (global.p_WB - p_NW) + t * dv_W, R_WN * global.v_WB + dv_W};
    estimate.covariance.setZero();
    estimate.covariance.diagonal().segment<3>(6).setConstant(velocity_std_mps * velocity_std_mps);
    return estimate;
  }
};

/// Feeds states at 10 Hz and fixes at 1 Hz between them, and stops at the alignment or after `seconds`.
std::optional<GnssAlignment> Follow(const FixWalk& walk, double seconds, FixAligner* aligner) {
  RandomStream noise(walk.seed, "noise");
  RandomStream wrong(walk.seed, "wrong");
  int fixes = 0;
  for (int i = 0; i * 0.1 < seconds; ++i) {
    const double t = 0.1 * i;
    for (; fixes + 0.537 < t; ++fixes) {
      const double next = fixes + 0.537;
      const NavState nav = walk.Global(next);
      Vector3d p_NA = nav.p_WB + nav.R_WB * walk.sensor.p_BA + walk.std_m * noise.Normal3();
      const double size = wrong.Uniform(10, 50);
      const double angle = wrong.Uniform(0, 2 * M_PI);
      if (wrong.Chance(walk.wrong_rate)) {
        p_NA += size * Vector3d(std::cos(angle), std::sin(angle), 0);
      }
      aligner->AddFix({SecondsToNs(next), 0, p_NA, walk.std_m * walk.std_m * Eigen::Matrix3d::Identity()});
    }
    aligner->AddState(walk.Local(t));
    if (auto alignment = aligner->TryAlign()) {
      return alignment;
    }
  }
  return std::nullopt;
}

double YawError(const FixWalk& walk, const GnssAlignment& alignment) {
  return std::remainder(alignment.yaw_rad - walk.yaw_rad, 2 * M_PI);
}

TEST(FixAlignerTest,
     GIVEN_fixes_of_a_metre_and_10_percent_wrong_THEN_it_aligns_within_15_s_and_is_consistent) {
  double normalized = 0;
  constexpr int kRuns = 20;
  for (unsigned seed = 1; seed <= kRuns; ++seed) {
    FixWalk walk;
    walk.seed = seed;
    walk.yaw_rad = 0.3 * seed;
    walk.wrong_rate = 0.1;
    FixAligner aligner({}, {walk.sensor}, std::nullopt);
    const auto alignment = Follow(walk, 15, &aligner);
    ASSERT_TRUE(alignment) << aligner.report();
    EXPECT_FALSE(alignment->clock.has_value());
    const double yaw_std = std::sqrt(alignment->covariance(0, 0));
    EXPECT_LT(std::abs(YawError(walk, *alignment)), 4 * yaw_std) << "seed " << seed;
    Eigen::Vector4d error;
    error << YawError(walk, *alignment), alignment->p_NW - walk.p_NW;
    normalized += error.dot(alignment->covariance.ldlt().solve(error)) / (4 * kRuns);
  }
  // Inflated by 1.5 in deviation: 0.44 where the fixes are white, as here.
  EXPECT_LT(normalized, 1);
  EXPECT_GT(normalized, 0.15);
}

TEST(FixAlignerTest, GIVEN_fixes_of_2_cm_and_a_third_wrong_THEN_no_wrong_one_counts) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    FixWalk walk;
    walk.seed = seed;
    walk.std_m = 0.02;
    walk.wrong_rate = 0.33;
    FixAligner aligner({}, {walk.sensor}, std::nullopt);
    const auto alignment = Follow(walk, 15, &aligner);
    ASSERT_TRUE(alignment) << aligner.report();
    EXPECT_LT(std::abs(YawError(walk, *alignment)), 0.02) << alignment->report;
    const Vector3d p_NA = (alignment->Transform() * walk.Local(5).nav).p_WB;
    EXPECT_LT((p_NA - walk.Global(5).p_WB).norm(), 0.3) << alignment->report;
  }
}

TEST(FixAlignerTest, GIVEN_no_motion_THEN_it_waits_and_says_so) {
  FixWalk walk;
  walk.speed_mps = 0;
  FixAligner aligner({}, {walk.sensor}, std::nullopt);
  EXPECT_FALSE(Follow(walk, 30, &aligner));
  EXPECT_NE(aligner.report().find("too little motion"), std::string::npos) << aligner.report();
}

TEST(FixAlignerTest, GIVEN_a_velocity_that_is_off_as_it_says_THEN_the_yaw_is_not_bent_by_it) {
  FixWalk walk;
  walk.std_m = 0.02;
  walk.dv_W = Vector3d(0.3, -0.2, 0.05);
  walk.velocity_std_mps = 0.3;
  FixAligner aligner({}, {walk.sensor}, std::nullopt);
  const auto alignment = Follow(walk, 15, &aligner);
  ASSERT_TRUE(alignment) << aligner.report();
  EXPECT_LT(std::abs(YawError(walk, *alignment)), 3 * std::sqrt(alignment->covariance(0, 0)));
  FixWalk sure = walk;
  sure.velocity_std_mps = 0;
  FixAligner other({}, {sure.sensor}, std::nullopt);
  const auto bent = Follow(sure, 15, &other);
  if (bent) {
    EXPECT_LT(std::abs(YawError(walk, *alignment)), std::abs(YawError(sure, *bent)));
  }
}

TEST(FixAlignerTest, GIVEN_fewer_fixes_than_it_needs_THEN_it_counts_them) {
  FixWalk walk;
  FixAligner aligner({}, {walk.sensor}, std::nullopt);
  EXPECT_FALSE(Follow(walk, 3, &aligner));
  EXPECT_NE(aligner.report().find("expected 5"), std::string::npos) << aligner.report();
}

TEST(FixAlignerTest, GIVEN_fixes_of_a_metre_THEN_the_kernel_is_the_configured_one) {
  const FixWalk walk;
  test::ExpectKernelIsTaken([&](RobustKernel kernel, double scale_sigma) {
    FixConfig config;
    config.robust_kernel = kernel;
    config.robust_scale_sigma = scale_sigma;
    FixAligner aligner(config, {walk.sensor}, std::nullopt);
    const auto alignment = Follow(walk, 30, &aligner);
    EXPECT_TRUE(alignment) << aligner.report();
    return alignment ? alignment->yaw_rad : 0;
  });
}

}  // namespace
}  // namespace alidade
