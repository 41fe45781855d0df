#include "core/outlying_observations.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/landmark_reduction.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::RandomStates;

constexpr double kSigma = 2e-3;

struct Views {
  Views(RandomStates* random, int count) {
    point = random->Vector(5);
    T_WC = random->CamerasLookingAt(point, count, 6, 2.0);
    for (const Pose& view : T_WC) {
      // Uniform, with the deviation kSigma: no observation is outlying by chance.
      const double half_width = std::sqrt(3.0) * kSigma;
      const Vector2d noise(random->Uniform(-half_width, half_width),
                           random->Uniform(-half_width, half_width));
      observations.push_back(
          {(view.Inverse() * point).hnormalized() + noise, Eigen::Matrix2d::Identity() / kSigma});
    }
  }
  void Disturb(int view, const Vector2d& sigmas) {
    observations[static_cast<size_t>(view)].z += kSigma * sigmas;
  }
  /// The views without those of the indices.
  [[nodiscard]] Views Without(const std::vector<int>& indices) const {
    Views rest = *this;
    rest.T_WC.clear();
    rest.observations.clear();
    for (size_t k = 0; k < T_WC.size(); ++k) {
      if (std::find(indices.begin(), indices.end(), static_cast<int>(k)) == indices.end()) {
        rest.T_WC.push_back(T_WC[k]);
        rest.observations.push_back(observations[k]);
      }
    }
    return rest;
  }

  Vector3d point;
  std::vector<Pose> T_WC;
  std::vector<NormalizedObservation> observations;
};

/// The rows of a track without its landmark, linearised at a point, of poses with white errors.
struct Rows {
  Rows(const Views& views, const Vector3d& at, double pose_sigma) {
    TrackLinearization track;
    EXPECT_TRUE(LinearizeTrack(views.T_WC, views.observations, at, &track));
    const Eigen::Index count = track.residual.size();
    // Beside the poses the identity: what elimination leaves of it maps the observations' noise.
    MatrixXd dense = MatrixXd::Zero(count, 4 * count);
    for (Eigen::Index k = 0; 2 * k < count; ++k) {
      dense.block<2, 6>(2 * k, 6 * k) = pose_sigma * track.pose_jacobians.middleRows<2>(2 * k);
    }
    dense.rightCols(count).setIdentity();
    EliminateLandmark(track.point_jacobian, dense, track.residual);
    const MatrixXd rows = dense.bottomRows(count - 3);
    const MatrixXd poses = rows.leftCols(3 * count);
    const Eigen::LLT<MatrixXd> covariance(poses * poses.transpose() +
                                          MatrixXd::Identity(count - 3, count - 3));
    innovation = covariance.matrixL().solve(track.residual.tail(count - 3));
    maps = covariance.matrixL().solve(rows.rightCols(count));
  }
  VectorXd innovation;
  MatrixXd maps;
};

const ChiSquareGate kGate(0.99);

TEST(OutlyingObservationsTest, WrongObservationsAreTakenOut) {
  RandomStates random(81);
  for (int trial = 0; trial < 50; ++trial) {
    Views views(&random, 9 + trial % 8);
    std::vector<int> wrong = {trial % 9, (trial + 4) % 9};
    views.Disturb(wrong[0], {25, 10});
    views.Disturb(wrong[1], {-8, 30});
    Rows rows(views, views.point, 1e-3);
    std::vector<int> outlying;
    ASSERT_TRUE(FindOutlyingObservations(kGate, rows.maps, rows.innovation, &outlying)) << trial;
    std::sort(wrong.begin(), wrong.end());
    std::sort(outlying.begin(), outlying.end());
    EXPECT_EQ(outlying, wrong) << trial;
  }
}

// GIVEN rows at one landmark WHEN observations are projected out THEN what is left is the normalised
// innovation squared of a track that never had them.
TEST(OutlyingObservationsTest, WhatIsLeftIsTheTrackWithoutThem) {
  RandomStates random(82);
  for (int trial = 0; trial < 20; ++trial) {
    Views views(&random, 8);
    views.Disturb(trial % 8, {20, -20});
    Rows rows(views, views.point, 1e-3);
    std::vector<int> outlying;
    ASSERT_TRUE(FindOutlyingObservations(kGate, rows.maps, rows.innovation, &outlying));
    const Rows rest(views.Without(outlying), views.point, 1e-3);
    EXPECT_NEAR(rows.innovation.squaredNorm(), rest.innovation.squaredNorm(),
                1e-9 * rest.innovation.squaredNorm());
  }
}

TEST(OutlyingObservationsTest, ATrackThatPassesLosesNone) {
  RandomStates random(83);
  Rows rows(Views(&random, 10), Vector3d::Zero(), 1e-3);
  rows.innovation.setConstant(0.5);
  std::vector<int> outlying = {3};
  EXPECT_TRUE(FindOutlyingObservations(kGate, rows.maps, rows.innovation, &outlying));
  EXPECT_TRUE(outlying.empty());
}

// GIVEN a landmark that moves WHEN every view contradicts the others a little THEN no third of them explains
// it.
TEST(OutlyingObservationsTest, AMovingPointIsRefusedWhole) {
  RandomStates random(84);
  for (int trial = 0; trial < 20; ++trial) {
    Views views(&random, 12);
    for (int k = 0; k < 12; ++k) {
      views.Disturb(k, Vector2d(4.0 * k, random.Uniform(-2, 2)));
    }
    Rows rows(views, views.point, 1e-3);
    std::vector<int> outlying;
    EXPECT_FALSE(FindOutlyingObservations(kGate, rows.maps, rows.innovation, &outlying)) << trial;
  }
}

TEST(OutlyingObservationsTest, OfThreeViewsNoneIsKnownToBeWrong) {
  RandomStates random(85);
  Views views(&random, 3);
  views.Disturb(1, {40, 40});
  Rows rows(views, views.point, 0);
  std::vector<int> outlying;
  EXPECT_FALSE(FindOutlyingObservations(kGate, rows.maps, rows.innovation, &outlying));
}

// GIVEN observations so far off that the least squares of all views mean nothing THEN those that agree on a
// landmark are found.
TEST(OutlyingObservationsTest, AConsensusNeedsNoLandmarkOfAll) {
  RandomStates random(86);
  for (int trial = 0; trial < 50; ++trial) {
    Views views(&random, 10);
    const std::vector<int> wrong = {trial % 5, 5 + trial % 4};
    views.Disturb(wrong[0], {300, -300});
    views.Disturb(wrong[1], {-400, 200});
    std::vector<int> outlying;
    ASSERT_TRUE(FindOutliersOfConsensus(views.T_WC, views.observations, &outlying)) << trial;
    EXPECT_EQ(outlying, wrong) << trial;
  }
  Views views(&random, 9);
  std::vector<int> outlying;
  EXPECT_FALSE(FindOutliersOfConsensus(views.T_WC, views.observations, &outlying)) << "all agree";
  for (const int k : {0, 2, 4, 6}) {
    views.Disturb(k, {random.Uniform(100, 300), random.Uniform(-300, -100)});
  }
  EXPECT_FALSE(FindOutliersOfConsensus(views.T_WC, views.observations, &outlying)) << "too few agree";
}

// GIVEN outliers spread over the frames THEN none is suspect; GIVEN most of one frame's observations outlying
// THEN that frame is, unless they are few.
TEST(FrameOutliersTest, MostOfOneFrameMakeItSuspect) {
  FrameOutliers frames;
  frames.Begin(3);
  for (int i = 0; i < 20; ++i) {
    for (int frame = 0; frame < 3; ++frame) {
      frames.AddSeen(frame);
    }
    frames.AddOutlying(i % 3);
  }
  EXPECT_FALSE(frames.AnySuspect(0.5));
  for (int i = 0; i < 4; ++i) {
    frames.AddOutlying(2);
  }
  EXPECT_FALSE(frames.AnySuspect(0.5)) << "ten of twenty";
  frames.AddOutlying(2);
  EXPECT_TRUE(frames.AnySuspect(0.5));
  frames.Begin(1);
  for (int i = 0; i < kLeastOutlyingOfFrame - 1; ++i) {
    frames.AddSeen(0);
    frames.AddOutlying(0);
  }
  EXPECT_FALSE(frames.AnySuspect(0.5));
}

}  // namespace
}  // namespace alidade
