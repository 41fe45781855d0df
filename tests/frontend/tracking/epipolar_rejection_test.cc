#include "frontend/tracking/epipolar_rejection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "core/lie.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFocalPx = 460;

Vector3d OnPlane(const Vector3d& p) {
  return p.hnormalized().homogeneous();
}

struct Scene {
  std::vector<BearingPair> pairs;
  std::vector<bool> outlier;
};

/// 120 points 2 to 8 m away seen from two places, 0.2 px noise; every fourth moved by 15 px in a random
/// direction.
Scene MakeScene(const Matrix3d& R_21, const Vector3d& t, unsigned seed, bool with_outliers = true) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> noise(0, 0.2 / kFocalPx);
  Scene scene;
  for (int i = 0; i < 120; ++i) {
    const double depth = 5 + 3 * unit(random);
    const Vector3d p_1(0.7 * depth * unit(random), 0.5 * depth * unit(random), depth);
    BearingPair pair{.first = OnPlane(p_1), .second = OnPlane(R_21 * p_1 + t)};
    pair.first.head<2>() += Vector2d(noise(random), noise(random));
    pair.second.head<2>() += Vector2d(noise(random), noise(random));
    scene.outlier.push_back(with_outliers && i % 4 == 3);
    if (scene.outlier.back()) {
      const double direction = M_PI * unit(random);
      pair.second.head<2>() += 15 / kFocalPx * Vector2d(std::cos(direction), std::sin(direction));
    }
    scene.pairs.push_back(pair);
  }
  return scene;
}

/// The same all around the camera up to 110 degrees off its axis, as unit directions.
Scene MakeWideScene(const Matrix3d& R_21, const Vector3d& t, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> noise(0, 0.2 / kFocalPx);
  Scene scene;
  for (int i = 0; i < 120; ++i) {
    const double angle = 0.95 * (1 + unit(random)) + 0.02;
    const double azimuth = M_PI * unit(random);
    const Vector3d p_1 =
        (5 + 3 * unit(random)) *
        Vector3d(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle));
    const auto noisy = [&](const Vector3d& p) -> Vector3d {
      return (p.normalized() + Vector3d(noise(random), noise(random), noise(random))).normalized();
    };
    BearingPair pair{.first = noisy(p_1), .second = noisy(R_21 * p_1 + t)};
    scene.outlier.push_back(i % 4 == 3);
    if (scene.outlier.back()) {
      const Vector3d aside = pair.second.cross(Vector3d(unit(random), unit(random), unit(random)));
      pair.second = (pair.second + 15 / kFocalPx * aside.normalized()).normalized();
    }
    scene.pairs.push_back(pair);
  }
  return scene;
}

struct Verdict {
  int good_kept = 0;
  int good = 0;
  int bad_kept = 0;
  int bad = 0;
};

Verdict Classify(const Scene& scene, const std::vector<bool>& inliers) {
  Verdict verdict;
  for (size_t i = 0; i < inliers.size(); ++i) {
    ++(scene.outlier[i] ? verdict.bad : verdict.good);
    if (inliers[i]) {
      ++(scene.outlier[i] ? verdict.bad_kept : verdict.good_kept);
    }
  }
  return verdict;
}

const EpipolarOptions kOptions{.threshold_px = 1.0, .focal_px = kFocalPx, .dt_s = 0.05};

TEST(EpipolarRejection, FindsOutliersWithABiasedGyroscope) {
  // 4 mrad is 0.08 rad/s of bias over a frame, 1.8 px: more than the threshold, so the rotation must be
  // refined.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Matrix3d R_21 = so3::Exp({0.03, -0.05, 0.02});
    const Vector3d t = seed % 2 == 0 ? Vector3d(0.15, 0.02, 0.05) : Vector3d(0.02, 0.01, -0.2);
    const Scene scene = MakeScene(R_21, t, seed);
    const Matrix3d R_measured = so3::Exp({0.002, -0.003, 0.002}) * R_21;
    const Verdict verdict = Classify(scene, FindEpipolarInliers(scene.pairs, R_measured, kOptions));
    EXPECT_GE(verdict.good_kept, verdict.good * 95 / 100) << "seed " << seed;
    // An outlier along its own epipolar line, the right way, is indistinguishable from a near point.
    EXPECT_LE(verdict.bad_kept, verdict.bad / 4) << "seed " << seed;
  }
}

TEST(EpipolarRejection, OnTheSphereItFindsOutliersBesideAndBehindTheCamera) {
  EpipolarOptions options = kOptions;
  options.on_sphere = true;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Matrix3d R_21 = so3::Exp({0.03, -0.05, 0.02});
    const Vector3d t = seed % 2 == 0 ? Vector3d(0.15, 0.02, 0.05) : Vector3d(0.02, 0.01, -0.2);
    const Scene scene = MakeWideScene(R_21, t, seed);
    const Matrix3d R_measured = so3::Exp({0.002, -0.003, 0.002}) * R_21;
    const Verdict verdict = Classify(scene, FindEpipolarInliers(scene.pairs, R_measured, options));
    EXPECT_GE(verdict.good_kept, verdict.good * 95 / 100) << "seed " << seed;
    EXPECT_LE(verdict.bad_kept, verdict.bad / 4) << "seed " << seed;
  }
  // Without a rotation the fundamental matrix classifies only what lies ahead.
  const Scene scene = MakeWideScene(so3::Exp({0.03, -0.05, 0.02}), {0.15, 0.02, 0.05}, 3);
  const Verdict verdict = Classify(scene, FindEpipolarInliers(scene.pairs, std::nullopt, options));
  EXPECT_GE(verdict.good_kept, verdict.good * 85 / 100);
  EXPECT_LT(verdict.bad_kept, verdict.bad);
}

/// The same scene with `noise_px` more noise on the second image, and `outlier_px` on every tenth across the
/// direction of motion, x.
Verdict ClassifyWithScatter(double noise_px, double outlier_px) {
  Scene scene = MakeScene(Matrix3d::Identity(), {0.15, 0, 0}, 8, false);
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, noise_px / kFocalPx);
  for (size_t i = 0; i < scene.pairs.size(); ++i) {
    scene.outlier[i] = i % 10 == 0;
    scene.pairs[i].second.y() += scene.outlier[i] ? outlier_px / kFocalPx : noise(random);
  }
  return Classify(scene, FindEpipolarInliers(scene.pairs, Matrix3d::Identity(), kOptions));
}

TEST(EpipolarRejection, GIVEN_a_scatter_that_the_threshold_does_not_expect_THEN_it_grows) {
  const Verdict scattered = ClassifyWithScatter(0.8, 8);
  EXPECT_GE(scattered.good_kept, scattered.good * 93 / 100) << "a threshold of 1 px would reject a fifth";
  EXPECT_EQ(scattered.bad_kept, 0);
  const Verdict sharp = ClassifyWithScatter(0.1, 2);
  EXPECT_GE(sharp.good_kept, sharp.good * 97 / 100);
  EXPECT_EQ(sharp.bad_kept, 0) << "it did not grow without need";
}

TEST(EpipolarRejection, FindsOutliersWithoutGyroscope) {
  const Scene scene = MakeScene(so3::Exp({0.03, -0.05, 0.02}), {0.15, 0.02, 0.05}, 3);
  const Verdict verdict = Classify(scene, FindEpipolarInliers(scene.pairs, std::nullopt, kOptions));
  EXPECT_GE(verdict.good_kept, verdict.good * 85 / 100);
  EXPECT_LE(verdict.bad_kept, verdict.bad / 3);
}

TEST(EpipolarRejection, AWrongGyroscopeDoesNotCostTheTracks) {
  const Scene scene = MakeScene(so3::Exp({0.03, -0.05, 0.02}), {0.15, 0.02, 0.05}, 4);
  const Verdict verdict =
      Classify(scene, FindEpipolarInliers(scene.pairs, so3::Exp({-0.1, 0.2, 0.3}), kOptions));
  EXPECT_GE(verdict.good_kept, verdict.good * 85 / 100);
}

TEST(EpipolarRejection, WithoutParallaxRotationAloneDecides) {
  const Matrix3d R_21 = so3::Exp({0.03, -0.05, 0.02});
  const Scene scene = MakeScene(R_21, Vector3d::Zero(), 5);
  const Verdict verdict =
      Classify(scene, FindEpipolarInliers(scene.pairs, so3::Exp({0.003, 0, -0.003}) * R_21, kOptions));
  EXPECT_GE(verdict.good_kept, verdict.good * 97 / 100);
  EXPECT_LE(verdict.bad_kept, verdict.bad / 4);
}

TEST(EpipolarRejection, RejectsMotionAgainstTheOthersAlongTheEpipolarLine) {
  const Vector3d t(0.3, 0, 0);
  Scene scene = MakeScene(Matrix3d::Identity(), t, 6, false);
  for (size_t i = 0; i < scene.pairs.size(); i += 6) {
    scene.pairs[i].second = scene.pairs[i].first - Vector3d(12 / kFocalPx, 0, 0);  // depth -3.8 m
    scene.outlier[i] = true;
  }
  const Verdict verdict = Classify(scene, FindEpipolarInliers(scene.pairs, Matrix3d::Identity(), kOptions));
  EXPECT_EQ(verdict.bad_kept, 0);
  EXPECT_GE(verdict.good_kept, verdict.good * 97 / 100);
}

TEST(EpipolarRejection, KeepsAllOnTooFewPairs) {
  Scene scene = MakeScene(Matrix3d::Identity(), {0.1, 0, 0}, 7);
  scene.pairs.resize(kMinPairs - 1);
  for (const bool inlier : FindEpipolarInliers(scene.pairs, Matrix3d::Identity(), kOptions)) {
    EXPECT_TRUE(inlier);
  }
  EXPECT_TRUE(FindEpipolarInliers({}, std::nullopt, kOptions).empty());
}

TEST(EpipolarRejection, IdenticalPairsAreHarmless) {
  const std::vector<BearingPair> pairs(20, {.first = {0.1, 0.2, 1}, .second = {0.1, 0.2, 1}});
  for (const bool inlier : FindEpipolarInliers(pairs, Matrix3d::Identity(), kOptions)) {
    EXPECT_TRUE(inlier);
  }
}

}  // namespace
}  // namespace alidade
