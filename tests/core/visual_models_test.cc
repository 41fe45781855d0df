#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "core/inverse_depth.h"
#include "core/landmark_reduction.h"
#include "core/pose_only.h"
#include "tests/support/jacobian_checker.h"
#include "tests/support/pose_only_model.h"
#include "tests/support/random_states.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::PoseOnlyModel;
using test::RandomStates;

struct Scene {
  Vector3d point;
  std::vector<Pose> views;
  std::vector<Vector2d> z;

  [[nodiscard]] std::vector<NormalizedObservation> Observations(double sigma) const {
    std::vector<NormalizedObservation> observations;
    for (const Vector2d& each : z) {
      observations.push_back({each, Eigen::Matrix2d::Identity() / sigma});
    }
    return observations;
  }
};

Scene MakeScene(RandomStates* random, int views, double noise) {
  Scene scene;
  scene.point = random->Vector(5);
  scene.views = random->CamerasLookingAt(scene.point, views, 6, 1.0);
  for (const Pose& view : scene.views) {
    scene.z.push_back((view.Inverse() * scene.point).hnormalized() +
                      noise * Vector2d(random->Uniform(-1, 1), random->Uniform(-1, 1)));
  }
  return scene;
}

/// H over the views' errors in a convention: each view's 6 columns times its own chart Jacobian.
MatrixXd ToConvention(const MatrixXd& jacobian, const std::vector<Pose>& views, ErrorConvention convention) {
  MatrixXd out = jacobian;
  for (size_t k = 0; k < views.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(6 * k);
    out.middleCols<6>(column) = jacobian.middleCols<6>(column) * ChartJacobian(convention, views[k]);
  }
  return out;
}

std::vector<Pose> Move(const std::vector<Pose>& views, ErrorConvention convention, const VectorXd& xi) {
  std::vector<Pose> moved;
  for (size_t k = 0; k < views.size(); ++k) {
    moved.push_back(Retract(convention, views[k], Vector6d(xi.segment<6>(static_cast<Eigen::Index>(6 * k)))));
  }
  return moved;
}

TEST(PoseOnlyTest, NoiseFreeViewsGiveTheLandmarkAndZeroResidual) {
  RandomStates random(31);
  for (int trial = 0; trial < 20; ++trial) {
    const Scene scene = MakeScene(&random, 3 + trial % 5, 0);
    for (const DepthViews views : {DepthViews::kMulti, DepthViews::kTwo}) {
      PoseOnlyDepth depth;
      VectorXd residual;
      ASSERT_TRUE((PoseOnlyModel{trial % 3, views}.Evaluate(scene.views, scene.z, &depth, &residual, nullptr,
                                                            nullptr)));
      EXPECT_LT((depth.p_W - scene.point).norm(), 1e-10);
      EXPECT_LT(residual.norm(), 1e-12);
    }
  }
}

TEST(PoseOnlyTest, JacobiansAreNumericInEveryConvention) {
  RandomStates random(32);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 24; ++trial) {
      const Scene scene = MakeScene(&random, 3 + trial % 4, 5e-3);
      const PoseOnlyModel model{trial % 3, trial % 2 == 0 ? DepthViews::kMulti : DepthViews::kTwo};
      PoseOnlyDepth depth;
      VectorXd residual;
      MatrixXd jacobian = MatrixXd::Constant(1, 1, std::numeric_limits<double>::quiet_NaN());
      MatrixXd noise_jacobian;
      ASSERT_TRUE(model.Evaluate(scene.views, scene.z, &depth, &residual, &jacobian, &noise_jacobian));
      VectorXd alone;
      ASSERT_TRUE(model.Evaluate(scene.views, scene.z, &depth, &alone, nullptr, nullptr));
      EXPECT_EQ(residual, alone);
      const auto move = [&](const VectorXd& xi) -> VectorXd {
        PoseOnlyDepth unused;
        VectorXd r;
        EXPECT_TRUE(
            model.Evaluate(Move(scene.views, convention, xi), scene.z, &unused, &r, nullptr, nullptr));
        return r;
      };
      const int count = static_cast<int>(scene.views.size());
      EXPECT_EQ(test::CompareJacobians(ToConvention(jacobian, scene.views, convention),
                                       test::NumericJacobian(move, 6 * count), 1e-7),
                "");
      const auto disturb = [&](const VectorXd& noise) -> VectorXd {
        std::vector<Vector2d> z = scene.z;
        VectorXd shift(2 * count);
        for (int k = 0; k < count; ++k) {
          z[static_cast<size_t>(k)] += noise.segment<2>(2 * k);
          shift.segment<2>(2 * k) = noise.segment<2>(2 * k);
        }
        PoseOnlyDepth unused;
        VectorXd r;
        EXPECT_TRUE(model.Evaluate(scene.views, z, &unused, &r, nullptr, nullptr));
        return r + shift;  // the prediction alone
      };
      EXPECT_EQ(test::CompareJacobians(noise_jacobian, test::NumericJacobian(disturb, 2 * count), 1e-7), "");
    }
  }
}

// Null space of paper eq. 4-9: a turn about gravity and a shift of all views change nothing, whatever the
// state.
TEST(PoseOnlyTest, RightInvariantRowsAnnihilateTheUnobservableDirections) {
  RandomStates random(33);
  for (int trial = 0; trial < 20; ++trial) {
    const Scene scene = MakeScene(&random, 5, 2e-2);  // far from the truth
    PoseOnlyDepth depth;
    VectorXd residual;
    MatrixXd jacobian;
    ASSERT_TRUE((PoseOnlyModel{}.Evaluate(scene.views, scene.z, &depth, &residual, &jacobian, nullptr)));
    const MatrixXd H = ToConvention(jacobian, scene.views, ErrorConvention::kRightInvariant);
    MatrixXd null_space = MatrixXd::Zero(30, 6);
    for (int k = 0; k < 5; ++k) {
      null_space.block<3, 3>(6 * k, 0).setIdentity();      // every theta block: any common turn
      null_space.block<3, 3>(6 * k + 3, 3).setIdentity();  // every p block: any common shift
    }
    EXPECT_LT((H * null_space).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(PoseOnlyTest, RefusesViewsWithoutParallaxAndLandmarksBehind) {
  RandomStates random(34);
  Scene scene = MakeScene(&random, 3, 0);
  const std::vector<Pose> same(3, scene.views[0]);
  const std::vector<NormalizedObservation> same_z(3, {scene.z[0], Eigen::Matrix2d::Identity()});
  PoseOnlyDepth depth;
  EXPECT_FALSE(ComputePoseOnlyDepth(same, same_z, 0, DepthViews::kMulti, &depth));
  for (Pose& view : scene.views) {
    view.rotation = view.rotation * so3::Exp(Vector3d(M_PI, 0, 0));  // cameras turned away, lines unchanged
  }
  for (Vector2d& each : scene.z) {
    each.x() = -each.x();
  }
  VectorXd residual;
  EXPECT_FALSE((PoseOnlyModel{}.Evaluate(scene.views, scene.z, &depth, &residual, nullptr, nullptr)));
}

TEST(InverseDepthTest, JacobiansAreNumericInEveryConvention) {
  RandomStates random(35);
  for (const ErrorConvention convention : test::kAllConventions) {
    for (int trial = 0; trial < 20; ++trial) {
      const Scene scene = MakeScene(&random, 2, 5e-3);
      const double rho = 1 / (scene.views[0].Inverse() * scene.point).z() + random.Uniform(-0.02, 0.02);
      const Vector3d landmark(scene.z[0].x(), scene.z[0].y(), rho);
      const InverseDepthModel model{scene.z[1]};
      Vector2d residual;
      InverseDepthModel::PoseJacobian base;
      InverseDepthModel::PoseJacobian view;
      InverseDepthModel::LandmarkJacobian by_landmark;
      ASSERT_TRUE(
          model.Evaluate(scene.views[0], scene.views[1], landmark, &residual, &base, &view, &by_landmark));
      Vector2d alone;
      ASSERT_TRUE(
          model.Evaluate(scene.views[0], scene.views[1], landmark, &alone, nullptr, nullptr, nullptr));
      EXPECT_EQ(residual, alone);
      const auto move = [&](const VectorXd& xi) -> VectorXd {
        Vector2d r;
        EXPECT_TRUE(model.Evaluate(Retract(convention, scene.views[0], Vector6d(xi.head<6>())),
                                   Retract(convention, scene.views[1], Vector6d(xi.segment<6>(6))),
                                   landmark + Vector3d(xi.tail<3>()), &r, nullptr, nullptr, nullptr));
        return r;
      };
      MatrixXd analytic(2, 15);
      analytic << base * ChartJacobian(convention, scene.views[0]),
          view * ChartJacobian(convention, scene.views[1]), by_landmark;
      EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(move, 15), 1e-8), "");
    }
  }
}

TEST(InverseDepthTest, InfinityIsRegularAndBehindIsRefused) {
  const InverseDepthModel model{Vector2d(0.1, -0.2)};
  const Pose here;
  Pose aside;
  aside.translation = Vector3d(1, 0, 0);
  Vector2d residual;
  ASSERT_TRUE(model.Evaluate(here, aside, {0.1, -0.2, 0.0}, &residual, nullptr, nullptr, nullptr));
  EXPECT_LT(residual.norm(), 1e-15) << "a point at infinity does not see translation";
  aside.translation = Vector3d(0, 0, 3);
  EXPECT_FALSE(model.Evaluate(here, aside, {0.1, -0.2, 0.5}, &residual, nullptr, nullptr, nullptr));
}

MatrixXd DensePoseJacobian(const TrackLinearization& linearization) {
  const Eigen::Index views = linearization.residual.size() / 2;
  MatrixXd dense = MatrixXd::Zero(2 * views, 6 * views);
  for (Eigen::Index k = 0; k < views; ++k) {
    dense.block<2, 6>(2 * k, 6 * k) = linearization.pose_jacobians.middleRows<2>(2 * k);
  }
  return dense;
}

TEST(LandmarkReductionTest, LinearizationIsNumeric) {
  RandomStates random(36);
  const Scene scene = MakeScene(&random, 4, 5e-3);
  const std::vector<NormalizedObservation> observations = scene.Observations(0.003);
  TrackLinearization linearization;
  ASSERT_TRUE(LinearizeTrack(scene.views, observations, scene.point, &linearization));
  const auto move = [&](const VectorXd& xi) -> VectorXd {
    TrackLinearization moved;
    EXPECT_TRUE(LinearizeTrack(Move(scene.views, ErrorConvention::kSo3xRn, xi.head(24)), observations,
                               scene.point + Vector3d(xi.tail<3>()), &moved));
    return moved.residual;
  };
  MatrixXd analytic(8, 27);
  analytic << DensePoseJacobian(linearization), linearization.point_jacobian;
  EXPECT_EQ(test::CompareJacobians(analytic, test::NumericJacobian(move, 27), 1e-8), "");
}

// The finding of docs/pose_only.md: on equal observations and linearisation point, the pose-only rows (total
// derivative through the depth) and the MSCKF rows (landmark held fixed) are the same 2N-3 rows.
TEST(LandmarkReductionTest, PoseOnlyUpdateIsTheMsckfUpdate) {
  RandomStates random(37);
  for (int trial = 0; trial < 20; ++trial) {
    const int count = 3 + trial % 6;
    const Scene scene = MakeScene(&random, count, 4e-3);
    PoseOnlyDepth depth;
    VectorXd residual;
    MatrixXd total;
    MatrixXd noise;
    ASSERT_TRUE((PoseOnlyModel{}.Evaluate(scene.views, scene.z, &depth, &residual, &total, &noise)));
    TrackLinearization linearization;
    ASSERT_TRUE(LinearizeTrack(scene.views, scene.Observations(1), depth.p_W, &linearization));
    const MatrixXd fixed = DensePoseJacobian(linearization);
    const Eigen::JacobiSVD<MatrixXd> svd(linearization.point_jacobian, Eigen::ComputeFullU);
    const MatrixXd N = svd.matrixU().rightCols(2 * count - 3);
    EXPECT_LT((N.transpose() * total - N.transpose() * fixed).cwiseAbs().maxCoeff(), 1e-12);
    // ... and the noise of those rows is untouched by the depth: N^T H_n = N^T.
    EXPECT_LT((N.transpose() * noise).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(LandmarkReductionTest, RankOfTheNoiseFreePoseOnlyJacobianIs2NMinus3) {
  RandomStates random(38);
  for (int count = 3; count <= 8; ++count) {
    const Scene scene = MakeScene(&random, count, 0);
    PoseOnlyDepth depth;
    VectorXd residual;
    MatrixXd total;
    ASSERT_TRUE((PoseOnlyModel{}.Evaluate(scene.views, scene.z, &depth, &residual, &total, nullptr)));
    Eigen::JacobiSVD<MatrixXd> svd(total);
    svd.setThreshold(1e-9);
    EXPECT_EQ(svd.rank(), 2 * count - 3);
  }
}

TEST(LandmarkReductionTest, EliminationKeepsTheProjectedNormalEquations) {
  RandomStates random(39);
  for (int trial = 0; trial < 20; ++trial) {
    const int count = 2 + trial % 7;
    const Scene scene = MakeScene(&random, count, 4e-3);
    TrackLinearization linearization;
    ASSERT_TRUE(LinearizeTrack(scene.views, scene.Observations(0.002), scene.point, &linearization));
    MatrixXd H = DensePoseJacobian(linearization);
    VectorXd r = linearization.residual;
    const MatrixXd F = linearization.point_jacobian;
    const MatrixXd projector = MatrixXd::Identity(2 * count, 2 * count) -
                               F * (F.transpose() * F).ldlt().solve(MatrixXd(F.transpose()));
    const MatrixXd information = H.transpose() * projector * H;
    const VectorXd gradient = H.transpose() * projector * r;
    EliminateLandmark(linearization.point_jacobian, H, r);
    const MatrixXd reduced = H.bottomRows(2 * count - 3);
    const double scale = information.cwiseAbs().maxCoeff();
    EXPECT_LT((reduced.transpose() * reduced - information).cwiseAbs().maxCoeff(), 1e-9 * scale);
    EXPECT_LT((reduced.transpose() * r.tail(2 * count - 3) - gradient).cwiseAbs().maxCoeff(), 1e-9 * scale);
  }
}

}  // namespace
}  // namespace alidade
