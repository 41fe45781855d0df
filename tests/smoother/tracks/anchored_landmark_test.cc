#include "smoother/tracks/anchored_landmark.h"

#include <gtest/gtest.h>

#include "tests/smoother/factors/slam_fixture.h"

namespace alidade {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::CompareJacobians;
using test::NumericJacobian;
using test::SlamFixture;
using AnchoredLandmarkTest = test::SlamFixtureTest;

TEST_P(AnchoredLandmarkTest, RowsOfAnAnchoredViewAgainstDifferences) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const SlamFixture fixture = Fixture(seed, {3, 4});
    const std::vector<FrameGeometry> geometry = fixture.Geometry();
    const int size = 15 + fixture.calibration.size();
    for (const WindowTrack* track : fixture.change.after) {
      const WindowView& view = track->views[1];
      AnchoredRows rows;
      FrameGeometry row;
      ASSERT_TRUE(LinearizeAnchoredView(geometry[static_cast<size_t>(track->anchor->index)],
                                        AtRow(geometry, view, &row), view.observation, {}, track->landmark,
                                        &rows, true, fixture.calibration, track->plane()));
      MatrixXd analytic(2, size);
      analytic << rows.anchor * ChartJacobian(convention(), track->anchor->nav_state().T_WB()),
          rows.view * ChartJacobian(convention(), view.frame->nav_state().T_WB()), rows.landmark,
          rows.calibration;
      const auto residual = [&](const VectorXd& delta) { return fixture.ViewResidual(*track, view, delta); };
      // A step of a microsecond a row moves the last row by a third of a millisecond.
      EXPECT_EQ(CompareJacobians(analytic, NumericJacobian(residual, size), 5e-6), "");
      EXPECT_LT((rows.residual - residual(VectorXd::Zero(size))).norm(), 1e-9);
    }
  }
}

TEST_P(AnchoredLandmarkTest, ChangeOfAnchorAgainstDifferences) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const SlamFixture fixture = Fixture(seed, {3});
    const WindowTrack& track = *fixture.change.after.front();
    const WindowFrame& from = *track.anchor;
    const WindowFrame& to = fixture.window.frame(1);
    const int size = 15 + fixture.calibration.size();
    const auto geometry = [&](const WindowFrame& frame, const VectorXd& pose, const VectorXd& delta) {
      return fixture.MovedGeometry(frame, pose, delta.tail(fixture.calibration.size()));
    };
    const VectorXd none = VectorXd::Zero(size);
    const FrameGeometry from_now = geometry(from, none.head<6>(), none);
    const FrameGeometry to_now = geometry(to, none.head<6>(), none);
    const AnchorPlanes planes{track.plane(), PlaneInAnchor(from_now, track.plane(), to_now, track.landmark)};
    AnchorChange change;
    ASSERT_TRUE(ChangeAnchor(from_now, to_now, track.landmark, &change, fixture.calibration.layout, planes));
    const auto old_coordinates = [&](const VectorXd& delta) -> VectorXd {
      AnchorChange back;
      EXPECT_TRUE(ChangeAnchor(geometry(to, delta.segment<6>(6), delta),
                               geometry(from, delta.head<6>(), delta), change.to + delta.segment<3>(12),
                               &back, {}, {planes.to, planes.from}));
      return back.to;
    };
    EXPECT_LT((old_coordinates(none) - track.landmark).norm(), 1e-12);
    MatrixXd analytic(3, size);
    analytic << change.from_frame * ChartJacobian(convention(), from.nav_state().T_WB()),
        change.to_frame * ChartJacobian(convention(), to.nav_state().T_WB()), change.landmark,
        change.calibration;
    EXPECT_EQ(CompareJacobians(analytic, NumericJacobian(old_coordinates, size), 1e-6), "");
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, AnchoredLandmarkTest, test::AllSlamFixtures(), test::NameOfSlamFixture);

}  // namespace
}  // namespace alidade
