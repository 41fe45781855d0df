#include "smoother/tracks/track_system.h"

#include <gtest/gtest.h>

#include "core/landmark_reduction.h"
#include "smoother/tracks/track_landmark.h"
#include "tests/smoother/window/window_fixture.h"

namespace alidade {
namespace {

using test::WindowFixture;

/// The same rows from the shared library: linearise, EliminateLandmark, J^T [J | r] of the 2N-3 rows, over
/// body poses.
void ExpectSystemOfEliminateLandmark(const WindowFixture& fixture, const WindowTrack& track,
                                     const PoseSystem& system) {
  const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
  std::vector<Pose> poses;
  std::vector<NormalizedObservation> observations;
  for (const WindowView& view : track.views) {
    poses.push_back(geometry[static_cast<size_t>(view.frame->index)].T_WC);
    observations.push_back(view.observation);
  }
  const Eigen::Vector3d p_W =
      poses.front() * (Eigen::Vector3d(track.landmark.x(), track.landmark.y(), 1) / track.landmark.z());
  TrackLinearization rows;
  ASSERT_TRUE(LinearizeTrack(poses, observations, p_W, &rows));
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows.residual.size(), 6 * fixture.window.size());
  for (size_t k = 0; k < track.views.size(); ++k) {
    const int index = track.views[k].frame->index;
    const Eigen::Index row = 2 * static_cast<Eigen::Index>(k);
    jacobian.block<2, 6>(row, 6 * index) =
        rows.pose_jacobians.middleRows<2>(row) * geometry[static_cast<size_t>(index)].camera_from_body;
  }
  EliminateLandmark(rows.point_jacobian, jacobian, rows.residual);
  const Eigen::MatrixXd kept = jacobian.bottomRows(jacobian.rows() - 3);
  const Eigen::MatrixXd expected = kept.transpose() * kept;
  const Eigen::MatrixXd found = system.hessian.selfadjointView<Eigen::Lower>();
  EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm());
  const Eigen::VectorXd gradient = kept.transpose() * rows.residual.tail(kept.rows());
  EXPECT_LT((system.gradient - gradient).norm(), 1e-9 * (1 + gradient.norm()) * 1e2);
}

TEST(TrackSystemTest, AddTrackGivesTheNormalEquationsOfEliminateLandmark) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    WindowFixture fixture(seed, 5, 2, 1.0);
    const WindowTrack& track = *fixture.tracks().front();
    PoseSystem system(5);
    TrackWorkspace workspace;
    ASSERT_TRUE(AddTrack(track.views, MakeGeometry(fixture.window, fixture.T_BC), {}, track.landmark,
                         &workspace, &system));
    ExpectSystemOfEliminateLandmark(fixture, track, system);
    EXPECT_EQ(system.dof, 2 * static_cast<int>(track.views.size()) - 3);
  }
}

TEST(TrackSystemTest, SolveLandmarkFindsTheMinimumOfTheRobustCost) {
  for (const RobustKernel kernel :
       {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy, RobustKernel::kLogTail}) {
    WindowFixture fixture(4, 5, 6, 2.0);
    const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
    const ObservationKernel robust{kernel, 1.0};
    for (const WindowTrack* track : fixture.tracks()) {
      Eigen::Vector3d landmark = track->landmark;
      ASSERT_TRUE(SolveLandmark(track->views, geometry, robust, 50, &landmark));
      const auto cost = [&](const Eigen::Vector3d& at) {
        PoseSystem system(5);
        TrackWorkspace workspace;
        EXPECT_TRUE(AddTrack(track->views, geometry, robust, at, &workspace, &system));
        return system.robust_cost;
      };
      const double best = cost(landmark);
      for (int i = 0; i < 3; ++i) {
        for (const double sign : {-1.0, 1.0}) {
          EXPECT_GE(cost(landmark + sign * 1e-4 * Eigen::Vector3d::Unit(i)), best);
        }
      }
    }
  }
}

TEST(TrackSystemTest, ExactObservationsGiveTheExactLandmarkFromThePoseOnlyDepth) {
  WindowFixture fixture(6, 5, 6);
  const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
  for (const WindowTrack* track : fixture.tracks()) {
    Eigen::Vector3d landmark;
    ASSERT_TRUE(InitializeLandmark(track->views, geometry, 1, &landmark));
    EXPECT_LT((landmark - track->landmark).norm(), 1e-9);
    EXPECT_LT(TrackChiSquare(track->views, geometry, landmark), 1e-12);
  }
}

// GIVEN views whose noise is drawn many times and poses that are known, THEN the inverse depth scatters as
// its deviation.
TEST(TrackSystemTest, TheInverseDepthScattersByItsDeviation) {
  WindowFixture fixture(12, 5, 1);
  const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
  const WindowTrack& track = *fixture.tracks().front();
  const std::optional<double> deviation = InverseDepthDeviation(track.views, geometry, {}, track.landmark);
  ASSERT_TRUE(deviation);
  constexpr int kDraws = 2000;
  double square = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<WindowView> views = track.views;
    for (WindowView& view : views) {
      const Eigen::Vector2d white(fixture.random.Gaussian(), fixture.random.Gaussian());
      view.observation.z += 0.1 * view.observation.sqrt_information.inverse() * white;
    }
    Eigen::Vector3d landmark = track.landmark;
    ASSERT_TRUE(SolveLandmark(views, geometry, {}, 50, &landmark));
    square += std::pow((landmark.z() - track.landmark.z()) / 0.1, 2) / kDraws;
  }
  EXPECT_NEAR(std::sqrt(square) / *deviation, 1, 0.06);
}

TEST(TrackSystemTest, WithoutBaselineThereIsNoLandmark) {
  WindowFixture fixture(6, 3, 4);
  std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
  WindowTrack track = *fixture.tracks().front();
  for (FrameGeometry& frame : geometry) {
    frame = geometry.front();
  }
  for (WindowView& view : track.views) {
    view.observation = track.views.front().observation;
  }
  Eigen::Vector3d landmark;
  EXPECT_FALSE(InitializeLandmark(track.views, geometry, 1, &landmark));
  PoseSystem system(3);
  TrackWorkspace workspace;
  EXPECT_FALSE(AddTrack(track.views, geometry, {}, track.landmark, &workspace, &system));
  EXPECT_EQ(system.hessian.norm(), 0) << "a refused track leaves no trace";
}

// GIVEN a rig at rest whose bearings scatter by their noise, THEN that parallax admits no track, however lax
// the gate.
TEST(TrackSystemTest, ParallaxOfTheNoiseAloneIsNoLandmark) {
  WindowFixture fixture(6, 10, 1);
  std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
  WindowTrack track = *fixture.tracks().front();
  const double sigma = track.views.front().observation.deviation();
  for (size_t k = 0; k < track.views.size(); ++k) {
    geometry[k] = geometry.front();
    const auto angle = static_cast<double>(k);
    track.views[k].observation.z =
        k == 0 ? Eigen::Vector2d(0, 0)
               : Eigen::Vector2d(2 * sigma * std::cos(angle), 2 * sigma * std::sin(angle));
  }
  ASSERT_GE(track.views.size(), 5u);
  Eigen::Vector3d landmark;
  EXPECT_FALSE(InitializeLandmark(track.views, geometry, 1, &landmark));
}

TEST(SquareRootRowsTest, ReproducesASemiDefiniteSystem) {
  test::RandomStates random(9);
  Eigen::MatrixXd rows(7, 12);
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    rows.data()[i] = random.Uniform(-100, 100);
  }
  rows.col(4).setZero();
  const Eigen::VectorXd r = rows.col(0) + 3 * rows.col(7);
  const Eigen::MatrixXd hessian = rows.transpose() * rows;
  const Eigen::VectorXd gradient = rows.transpose() * r;
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residual;
  SquareRootRows(hessian, gradient, &jacobian, &residual);
  EXPECT_LT((jacobian.transpose() * jacobian - hessian).norm(), 1e-10 * hessian.norm());
  EXPECT_LT((jacobian.transpose() * residual - gradient).norm(), 1e-8 * gradient.norm());
}

}  // namespace
}  // namespace alidade
