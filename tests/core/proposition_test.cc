// What of the paper's Proposition 1 holds (docs/equivalences.md). It compares the joint covariance of poses X
// and landmark f before an update:
//   MSCKF: f independent of X, infinite covariance;      pose-only: P_Xf = P_X H_g^T, P_f = H_g P_X H_g^T,
// with f = g(X, z) and H_g = dg/dX.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/error_convention.h"
#include "core/landmark_reduction.h"
#include "core/pose_only.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kViews = 5;
constexpr double kSigma = 2e-3;

/// One noise-free landmark, linearised at the truth; unit noise.
struct Scene {
  explicit Scene(unsigned seed) {
    test::RandomStates random(seed);
    point = random.Vector(4);
    views = random.CamerasLookingAt(point, kViews, 8, 2);
    for (const Pose& view : views) {
      const Vector3d p = view.Inverse() * point;
      observations.push_back({p.head<2>() / p.z(), Eigen::Matrix2d::Identity() / kSigma});
    }
    MatrixXd root = MatrixXd::NullaryExpr(6 * kViews, 6 * kViews, [&] { return random.Uniform(-1, 1); });
    prior = 1e-4 * root * root.transpose() + 1e-6 * MatrixXd::Identity(6 * kViews, 6 * kViews);
    TrackLinearization linearization;
    EXPECT_TRUE(LinearizeTrack(views, observations, point, &linearization));
    by_poses.setZero(2 * kViews, 6 * kViews);
    for (Index k = 0; k < kViews; ++k) {
      by_poses.block<2, 6>(2 * k, 6 * k) = linearization.pose_jacobians.middleRows<2>(2 * k);
    }
    by_landmark = linearization.point_jacobian;
    Differentiate();
  }

  /// dg/dX and dg/dz by central differences of the depth itself.
  void Differentiate() {
    constexpr double kStep = 1e-6;
    const auto g = [&](const VectorXd& pose_errors, const VectorXd& noise) {
      std::vector<Pose> moved = views;
      std::vector<NormalizedObservation> seen = observations;
      for (Index k = 0; k < kViews; ++k) {
        moved[static_cast<size_t>(k)] = Retract(ErrorConvention::kSo3xRn, moved[static_cast<size_t>(k)],
                                                Vector6d(pose_errors.segment<6>(6 * k)));
        seen[static_cast<size_t>(k)].z += noise.segment<2>(2 * k);
      }
      PoseOnlyDepth depth;
      EXPECT_TRUE(ComputePoseOnlyDepth(moved, seen, 0, DepthViews::kMulti, &depth));
      return depth.p_W;
    };
    h_g.resize(3, 6 * kViews);
    g_z.resize(3, 2 * kViews);
    const VectorXd no_error = VectorXd::Zero(6 * kViews);
    const VectorXd no_noise = VectorXd::Zero(2 * kViews);
    for (Index i = 0; i < h_g.cols(); ++i) {
      const VectorXd step = kStep * VectorXd::Unit(6 * kViews, i);
      h_g.col(i) = (g(step, no_noise) - g(-step, no_noise)) / (2 * kStep);
    }
    for (Index i = 0; i < g_z.cols(); ++i) {
      const VectorXd step = kStep * VectorXd::Unit(2 * kViews, i);
      g_z.col(i) = (g(no_error, step) - g(no_error, -step)) / (2 * kStep);
    }
    g_z *= kSigma;  // over unit noise
  }

  /// Rows that no landmark can explain.
  [[nodiscard]] MatrixXd LeftNull() const {
    const Eigen::JacobiSVD<MatrixXd> svd(by_landmark, Eigen::ComputeFullU);
    return svd.matrixU().rightCols(2 * kViews - 3);
  }

  /// The MSCKF's posterior of the poses.
  [[nodiscard]] MatrixXd MsckfPosterior() const {
    const MatrixXd h = LeftNull().transpose() * by_poses;
    return (prior.inverse() + h.transpose() * h).inverse();
  }

  Vector3d point;
  std::vector<Pose> views;
  std::vector<NormalizedObservation> observations;
  MatrixXd prior;
  MatrixXd by_poses;     ///< J: whitened rows with the landmark fixed
  MatrixXd by_landmark;  ///< F
  MatrixXd h_g;          ///< dg/dX
  MatrixXd g_z;          ///< dg/dz over unit noise
};

/// Relative difference of two matrices.
double Apart(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).norm() / b.norm();
}

TEST(PropositionOneTest, TheMsckfIsTheLimitOfAnInfinitePriorOnTheLandmark) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene(seed);
    const auto with_prior = [&](double variance) {
      MatrixXd h(2 * kViews, 6 * kViews + 3);
      h << scene.by_poses, scene.by_landmark;
      MatrixXd information = h.transpose() * h;
      information.topLeftCorner(6 * kViews, 6 * kViews) += scene.prior.inverse();
      information.bottomRightCorner<3, 3>() += Eigen::Matrix3d::Identity() / variance;
      return MatrixXd(information.inverse().topLeftCorner(6 * kViews, 6 * kViews));
    };
    EXPECT_LT(Apart(with_prior(1e10), scene.MsckfPosterior()), 1e-5);
    EXPECT_GT(Apart(with_prior(1e-4), scene.MsckfPosterior()), 1e-2) << "a known landmark is another matter";
  }
}

TEST(PropositionOneTest, TheLandmarkOfThePosesHasItsObservationsNoiseToo) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene(seed);
    // g returns the landmark that made the observations, so its derivatives obey G_z F = I and G = -G_z J.
    EXPECT_LT((scene.g_z * scene.by_landmark - Eigen::Matrix3d::Identity()).norm(), 1e-5);
    EXPECT_LT(Apart(scene.h_g, -scene.g_z * scene.by_poses), 1e-5);
    // With the poses known the paper's covariance of the landmark is zero; what is true is that of its
    // bearings.
    const MatrixXd missing = scene.g_z * scene.g_z.transpose();
    EXPECT_GT(missing.trace(), 3 * kSigma * kSigma);
    const Eigen::JacobiSVD<MatrixXd> svd(missing);
    EXPECT_GT(svd.singularValues()[2], 0) << "in every direction";
  }
}

/// With the noise of the observations, the pose-only joint (X, f) conditioned on all 2N residuals is the
/// joint posterior of the MSCKF: poses, landmark and their cross-covariance.
TEST(PropositionOneTest, WithThatNoiseBothJointPosteriorsAreTheSame) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene(seed);
    MatrixXd h(2 * kViews, 6 * kViews + 3);
    h << scene.by_poses, scene.by_landmark;
    MatrixXd information = h.transpose() * h;
    information.topLeftCorner(6 * kViews, 6 * kViews) += scene.prior.inverse();
    const MatrixXd msckf = information.inverse();
    // Over (X~, n): the truth is f = g(X, z - n), so f~ = H_g X~ - G_z n, and N^T (J X~ + n) is what is
    // measured.
    const Index all = 8 * kViews;
    MatrixXd unknowns = MatrixXd::Identity(all, all);
    unknowns.topLeftCorner(6 * kViews, 6 * kViews) = scene.prior;
    MatrixXd joint = MatrixXd::Zero(6 * kViews + 3, all);
    joint.topLeftCorner(6 * kViews, 6 * kViews).setIdentity();
    joint.bottomLeftCorner(3, 6 * kViews) = scene.h_g;
    joint.bottomRightCorner(3, 2 * kViews) = -scene.g_z;
    MatrixXd measured(2 * kViews - 3, all);
    measured << scene.LeftNull().transpose() * scene.by_poses, scene.LeftNull().transpose();
    const MatrixXd projected = measured * unknowns;
    const MatrixXd posterior =
        unknowns - projected.transpose() * (projected * measured.transpose()).ldlt().solve(projected);
    EXPECT_LT(Apart(joint * posterior * joint.transpose(), msckf), 1e-5);
  }
}

/// Taken as written, P_Ours as prior and the same observations as fresh noise (the "regular EKF update
/// without null-space projection"), the observations count twice.
TEST(PropositionOneTest, TakenAsWrittenTheObservationsCountTwice) {
  double mean_ratio = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Scene scene(seed);
    const MatrixXd& p = scene.prior;
    const MatrixXd h = scene.by_poses + scene.by_landmark * scene.h_g;
    const MatrixXd innovation = h * p * h.transpose() + MatrixXd::Identity(2 * kViews, 2 * kViews);
    const MatrixXd gain = innovation.ldlt().solve(h * p).transpose();
    const MatrixXd keeps = MatrixXd::Identity(p.rows(), p.rows()) - gain * h;
    const MatrixXd claimed = keeps * p;
    const MatrixXd h_n = MatrixXd::Identity(2 * kViews, 2 * kViews) - scene.by_landmark * scene.g_z;
    const MatrixXd actual = keeps * p * keeps.transpose() + gain * h_n * h_n.transpose() * gain.transpose();
    const double ratio = claimed.ldlt().solve(actual).trace() / static_cast<double>(p.rows());
    EXPECT_GT(ratio, 1.05) << "seed " << seed;
    mean_ratio += ratio / 10;
    // It is no better for it: its actual covariance is nowhere below that of the MSCKF.
    const MatrixXd worse = actual - scene.MsckfPosterior();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (worse + worse.transpose()));
    EXPECT_GT(eigen.eigenvalues()[0], -1e-6 * eigen.eigenvalues().cwiseAbs().maxCoeff());
  }
  RecordProperty("mean_nees_ratio", std::to_string(mean_ratio));
}

}  // namespace
}  // namespace alidade
