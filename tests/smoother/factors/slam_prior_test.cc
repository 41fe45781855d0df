#include "smoother/factors/slam_prior.h"

#include <gtest/gtest.h>

#include "core/reprojection.h"
#include "smoother/factors/slam_prior_factor.h"
#include "tests/smoother/factors/slam_fixture.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::DenseWindow;
using test::NumericJacobian;
using test::RowsAboutOrigin;
using test::SlamFixture;

using SlamPriorTest = test::SlamFixtureTest;

void ExpectPrior(const LinearPrior& prior, const DenseWindow& dense) {
  ASSERT_EQ(prior.columns().size(), dense.hessian.rows());
  const MatrixXd rows = RowsAboutOrigin(prior);
  const MatrixXd information = rows.transpose() * rows;
  EXPECT_LT((information - dense.hessian).norm(), 1e-6 * dense.hessian.norm());
  const VectorXd gradient = rows.transpose() * prior.residual;
  EXPECT_LT((gradient - dense.gradient).norm(), 1e-6 * dense.gradient.norm());
  // The calibration's columns are compared by themselves: those of the poses are far larger.
  const auto [at, size] = prior.columns().Calibration();
  const VectorXd scale = dense.hessian.diagonal().segment(at, size).cwiseSqrt().cwiseInverse();
  const MatrixXd own = scale.asDiagonal() * information.block(at, at, size, size) * scale.asDiagonal();
  const MatrixXd expected = scale.asDiagonal() * dense.hessian.block(at, at, size, size) * scale.asDiagonal();
  EXPECT_LE((own - expected).norm(), 1e-5 * expected.norm());
}

/// Every camera `scale` times as far from the last one, and every velocity as much larger.
void Grow(double scale, const Eigen::Vector3d& camera_B, std::vector<NavState>* states) {
  const Eigen::Vector3d centre = states->back().T_WB() * camera_B;
  for (NavState& state : *states) {
    state.p_WB = centre + scale * (state.T_WB() * camera_B - centre) - state.R_WB * camera_B;
    state.v_WB *= scale;
  }
}

// GIVEN tracks that keep their landmarks, WHEN their oldest frame leaves, THEN the prior is the Schur
// complement over prior, IMU and their views in that frame; no other view is used up.
TEST_P(SlamPriorTest, NewFeaturesGiveTheSchurComplement) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SlamFixture fixture = Fixture(seed, {3, 4});
    const size_t count = fixture.change.after.size();
    ASSERT_GT(count, 3u);
    DenseWindow dense(fixture, count);
    dense.AddImu();
    dense.AddPrior(fixture.first, 1, 0);
    std::vector<size_t> all;
    for (size_t i = 0; i < count; ++i) {
      const WindowTrack& track = *fixture.change.after[i];
      dense.AddView(track, track.views.front(), i);
      all.push_back(i);
    }
    dense.KeepPrior(all);
    ExpectPrior(fixture.Leave(), dense);
  }
}

// GIVEN a prior with landmarks, WHEN its oldest frame leaves, THEN a landmark anchored there is expressed in
// another frame and a lost one is eliminated with all of its views, nothing else being lost.
TEST_P(SlamPriorTest, AnchorsThatLeaveAndLostFeaturesGiveTheSchurComplement) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SlamFixture fixture = Fixture(seed, {1, 4});
    const LinearPrior prior = fixture.Leave();
    const std::vector<const WindowTrack*> tracks = PriorTracks(prior, fixture.window);
    const size_t count = tracks.size();
    const size_t lost = 1;
    const int frames = fixture.window.size();
    const Index cameras = fixture.calibration.size();
    DenseWindow dense(fixture, count);
    dense.AddImu();
    dense.AddPrior(prior, frames, count);
    std::vector<size_t> staying;
    for (size_t i = 0; i < count; ++i) {
      for (const WindowView& view : tracks[i]->views) {
        if (i == lost || view.frame->index == 0) {
          dense.AddView(*tracks[i], view, i);
        }
      }
      if (i != lost) {
        staying.push_back(i);
      }
    }
    // The landmarks' new coordinates, by differences of the change of anchor.
    MatrixXd substitute = MatrixXd::Identity(dense.hessian.rows(), dense.hessian.cols());
    SlamChange change{tracks, {}, {}, fixture.change.relative_to_spread};
    for (const size_t i : staying) {
      WindowTrack& track = fixture.window.tracks().at(tracks[i]->id);
      change.after.push_back(&track);
      if (track.anchor->index > 0) {
        continue;
      }
      const WindowFrame& from = *track.anchor;
      const WindowFrame& to = fixture.window.newest();
      const BearingPlane old_plane = track.plane();
      fixture.Anchor(&from, &to, &track);
      const auto old_coordinates = [&](const VectorXd& delta) -> VectorXd {
        AnchorChange back;
        EXPECT_TRUE(ChangeAnchor(fixture.MovedGeometry(to, delta.segment<6>(6), delta.tail(cameras)),
                                 fixture.MovedGeometry(from, delta.head<6>(), delta.tail(cameras)),
                                 track.landmark + delta.segment<3>(12), &back, {},
                                 {track.plane(), old_plane}));
        return back.to;
      };
      const MatrixXd jacobian = NumericJacobian(old_coordinates, static_cast<int>(15 + cameras));
      const Index row = dense.Landmark(i);
      substitute.block<3, 6>(row, 0) = jacobian.leftCols<6>();
      substitute.block<3, 6>(row, 15 * (frames - 1)) = jacobian.middleCols<6>(6);
      substitute.block<3, 3>(row, row) = jacobian.middleCols<3>(12);
      substitute.block(row, dense.Calibration(), 3, cameras) = jacobian.rightCols(cameras);
    }
    dense.hessian = (substitute.transpose() * dense.hessian * substitute).eval();
    dense.gradient = (substitute.transpose() * dense.gradient).eval();
    dense.KeepPrior(staying);
    ExpectPrior(test::Marginalize(fixture.window, prior, fixture.NoVision(), {fixture.gravity_W}, change),
                dense);
  }
}

// The factor's cost is the minimum over the landmarks, so its gradient is that of the cost: no derivative of
// the landmarks is missing; and its rows are its gradient and its Gauss-Newton matrix. So it is where the
// window has grown since the prior was made.
TEST_P(SlamPriorTest, ReducedSystemIsThatOfTheMinimumOverTheLandmarks) {
  for (const RobustKernel kernel : {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy}) {
    SlamFixture fixture = Fixture(7, {2, 4});
    const LinearPrior prior = fixture.Leave();
    const int frames = fixture.window.size();
    const std::vector<const WindowTrack*> tracks = PriorTracks(prior, fixture.window);
    const SlamPrior slam(&prior, tracks, fixture.window, fixture.calibration, {kernel, 1.5});
    WindowPoint origin = PointOf(fixture.window, fixture.calibration.mean);
    Grow(1.1, fixture.T_BC.translation, &origin.states);
    const auto reduce = [&](const VectorXd& zeta) {
      WindowPoint point = origin;
      for (int i = 0; i < frames; ++i) {
        Vector9d xi = Vector9d::Zero();
        xi.head(i == 0 ? 9 : 6) = zeta.segment(slam.columns().Frame(i).first, i == 0 ? 9 : 6);
        point.states[static_cast<size_t>(i)] =
            Retract(ErrorConvention::kSo3xRn, origin.states[static_cast<size_t>(i)], xi);
      }
      point.bias.gyro += zeta.segment<3>(9);
      point.bias.accel += zeta.segment<3>(12);
      point.camera = fixture.Moved(zeta.tail(fixture.calibration.size()));
      VectorXd landmarks = slam.StartingLandmarks();
      SlamPrior::Reduced reduced;
      for (int k = 0; k < 4; ++k) {  // re-weighting converges linearly
        EXPECT_TRUE(slam.Reduce(point, &landmarks, &reduced));
      }
      return reduced;
    };
    const SlamPrior::Reduced at = reduce(VectorXd::Zero(slam.columns().size()));
    // A step of the line delay moves the last row by hundreds of it.
    VectorXd unit = VectorXd::Ones(slam.columns().size());
    const CalibrationLayout& layout = fixture.calibration.layout;
    if (layout.line_delay() >= 0) {
      unit.tail(layout.size())[layout.line_delay()] = 1e-3;
    }
    const auto cost = [&](const VectorXd& steps) -> VectorXd {
      return VectorXd::Constant(1, reduce(unit.asDiagonal() * steps).robust_cost / 2);
    };
    const VectorXd gradient = unit.asDiagonal() * at.gradient;
    const VectorXd numeric = NumericJacobian(cost, static_cast<int>(unit.size()), 1e-4).transpose();
    EXPECT_LT((numeric - gradient).norm(), 1e-3 * gradient.norm()) << static_cast<int>(kernel);
    // A focal length's own, many orders below a rotation's.
    if (fixture.calibrated()) {
      EXPECT_LT((numeric - gradient).tail<4>().norm(), 1e-3 * gradient.tail<4>().norm());
    }
  }
}

// GIVEN a window that fits its data, WHEN the oldest frame leaves and its tracks keep their landmarks, THEN
// what is known about the newest state and the calibration stays the same.
TEST_P(SlamPriorTest, WhatIsKnownOfTheNewestStateStaysTheSame) {
  SlamFixture fixture = Fixture(9, {3, 4});
  for (auto& [id, track] : fixture.window.tracks()) {  // without noise, at their landmarks
    const std::vector<FrameGeometry> geometry = fixture.Geometry();
    FrameGeometry base_row, view_row;
    const FrameGeometry& base = track.anchor != nullptr ? geometry[static_cast<size_t>(track.anchor->index)]
                                                        : AtRow(geometry, track.views.front(), &base_row);
    for (WindowView& view : track.views) {
      const AnchoredPointInCamera seen(base.T_WC, AtRow(geometry, view, &view_row).T_WC, track.landmark,
                                       track.plane());
      view.observation.z = view.observation.plane.InAxes(seen.q).hnormalized();
      if (fixture.calibrated()) {
        ASSERT_TRUE(fixture.calibration.mean.camera.Project(seen.q, &view.pixel));
      }
    }
  }
  fixture.first.residual.setZero();
  const auto vision = [&](bool all) {
    const std::vector<FrameGeometry> geometry = fixture.Geometry();
    PoseSystem system = fixture.NoVision();
    TrackWorkspace workspace;
    for (const WindowTrack* track : fixture.tracks()) {
      Eigen::Vector3d landmark = track->landmark;
      AnchorChange back;
      FrameGeometry row;
      if (track->anchor != nullptr) {
        EXPECT_TRUE(ChangeAnchor(geometry[static_cast<size_t>(track->anchor->index)],
                                 AtRow(geometry, track->views.front(), &row), track->landmark, &back, {},
                                 {track->plane(), track->views.front().observation.plane}));
        landmark = back.to;
      }
      if (all || track->anchor == nullptr) {
        EXPECT_TRUE(AddTrack(track->views, geometry, {}, landmark, &workspace, &system));
      }
    }
    return system;
  };
  const SensorContext sensors{fixture.gravity_W};
  const NewestEstimate known_before = test::Newest(fixture.window, fixture.first, vision(true), sensors);
  const Matrix15d before = known_before.covariance;
  const VectorXd camera_before = known_before.calibration_deviations;
  const LinearPrior prior = fixture.Leave();
  const NewestEstimate known_after = test::Newest(
      fixture.window, prior, vision(false), sensors,
      std::make_unique<SlamPriorTerm>(prior, fixture.window, fixture.calibration, ObservationKernel{}));
  const Matrix15d after = known_after.covariance;
  const VectorXd camera_after = known_after.calibration_deviations;
  EXPECT_LT((after - before).norm(), 1e-5 * before.norm());
  ASSERT_EQ(camera_after.size(), fixture.calibration.size());
  // Within a narrow cone a coefficient of a curved lens is hardly seen.
  const double most_share = fixture.seen_view == test::FixtureView::kBehind ? 0.9999 : 0.999;
  for (Index i = 0; i < camera_after.size(); ++i) {
    EXPECT_NEAR(camera_after[i], camera_before[i], 1e-5 * camera_before[i]) << i;
    EXPECT_LT(camera_after[i], most_share * 1 / fixture.first.jacobian.diagonal()[15 + i]) << i;
  }
}

// Yaw and position of the whole window are unknown to vision and IMU, and stay so in the prior, also when the
// window has grown since.
TEST(SlamPriorGaugeTest, NothingIsLearntOfYawAndPosition) {
  SlamFixture fixture(8, ErrorConvention::kRightInvariant, false, {1, 4});
  fixture.first.jacobian.setZero();
  LinearPrior prior = fixture.Leave();
  for (int leave = 0; leave < 2; ++leave) {
    MatrixXd gauge = MatrixXd::Zero(prior.columns().size(), 4);
    for (int i = 0; i < static_cast<int>(prior.anchors.size()); ++i) {
      gauge(prior.columns().Frame(i).first + 2, 0) = 1;
      gauge.block<3, 3>(prior.columns().Frame(i).first + 3, 1).setIdentity();
    }
    EXPECT_LT((prior.jacobian * gauge).norm(), 1e-6 * prior.jacobian.norm());
    // Once more, with anchors that leave.
    SlamChange change{PriorTracks(prior, fixture.window), {}, {}, true};
    for (const WindowTrack* known : change.before) {
      WindowTrack& track = fixture.window.tracks().at(known->id);
      if (track.anchor->index == 0) {
        fixture.Anchor(track.anchor, &fixture.window.newest(), &track);
      }
      change.after.push_back(&track);
    }
    std::vector<NavState> states = PointOf(fixture.window, fixture.calibration.mean).states;
    Grow(1.2, fixture.T_BC.translation, &states);
    for (int i = 0; i < fixture.window.size(); ++i) {
      PackNavState(states[static_cast<size_t>(i)], fixture.window.frame(i).nav.data());
    }
    prior = test::Marginalize(fixture.window, prior, fixture.NoVision(), {fixture.gravity_W}, change);
  }
}

/// The prior of vision alone when the oldest frame leaves.
LinearPrior PriorOfVision(const SlamFixture& fixture) {
  LinearPrior nothing = fixture.first;
  nothing.jacobian.setZero();
  nothing.residual.setZero();
  WindowTerms terms;
  const PoseSystem no_vision = fixture.NoVision();
  terms.push_back(std::make_unique<test::GivenTerm>(no_vision));
  const Result<LinearPrior> prior =
      MarginalizeOldest(fixture.window, nothing, fixture.calibration, terms, fixture.change);
  EXPECT_TRUE(prior.ok()) << prior.message();
  return *prior;
}

// GIVEN a prior of vision alone, WHEN frames and landmarks have been found elsewhere since it was made THEN
// it prefers no scale of the window; without a spread it prefers one.
TEST(SlamPriorGaugeTest, NothingIsLearntOfTheScale) {
  for (const bool relative_to_spread : {true, false}) {
    const SlamFixture fixture(8, ErrorConvention::kRightInvariant, false, {3, 4}, test::FixtureView::kAhead,
                              relative_to_spread);
    const LinearPrior prior = PriorOfVision(fixture);
    const ColumnMap columns = prior.columns();
    std::vector<NavState> found = PointOf(fixture.window, fixture.calibration.mean).states;
    test::RandomStates random(5);
    for (NavState& state : found) {
      state.p_WB += random.Vector(0.05);
    }
    const auto residual = [&](double scale) -> VectorXd {
      std::vector<NavState> states = found;
      Grow(scale, fixture.T_BC.translation, &states);
      const LinearPrior::SpreadChange spread = prior.SpreadAt(states);
      const LinearPrior::FrameErrors errors = prior.ErrorsAt(states, spread, LinearPrior::Derivative::kHere);
      VectorXd xi = VectorXd::Zero(columns.size());
      for (size_t i = 0; i < prior.anchors.size(); ++i) {
        xi.segment<6>(columns.Frame(static_cast<int>(i)).first) = errors.xi[i].head<6>();
      }
      for (size_t l = 0; l < prior.landmarks.size(); ++l) {
        const double inverse_depth = prior.landmarks[l].origin.z() * (l % 2 == 0 ? 1.1 : 0.9) / scale;
        xi[columns.Landmark(static_cast<int>(l)).first + 2] =
            inverse_depth * spread.ratio - prior.landmarks[l].origin.z();
      }
      return prior.jacobian * xi;
    };
    const double difference = (residual(1.5) - residual(1)).norm() / residual(1).norm();
    if (relative_to_spread) {
      EXPECT_LT(difference, 1e-6);
    } else {
      EXPECT_GT(difference, 0.1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, SlamPriorTest, test::AllSlamFixtures(), test::NameOfSlamFixture);

}  // namespace
}  // namespace alidade
