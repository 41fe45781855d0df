#include <gtest/gtest.h>

#include "core/reprojection.h"
#include "smoother/factors/slam_prior_cost.h"
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

/// Expects of a prior of the fixture's window, where the window has grown to `growth` times its size, that
/// the gradient of the reduced system is that of its cost, by differences.
void ExpectGradient(const SlamFixture& fixture, const LinearPrior& prior, const ObservationKernel& kernel,
                    double growth) {
  const int frames = fixture.window.size();
  const SlamPrior slam(&prior, PriorTracks(prior, fixture.window), fixture.window, fixture.calibration,
                       kernel);
  WindowPoint origin = PointOf(fixture.window, fixture.calibration.mean);
  test::Grow(growth, fixture.T_BC.translation, &origin.states);
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
    SlamPriorCost reduced(&slam);
    double value = 0;
    for (int k = 0; k < 4; ++k) {  // re-weighting converges linearly
      value = reduced.Solve(point);
    }
    NormalEquations equations;
    EXPECT_TRUE(reduced.Linearize(&equations));
    return std::make_pair(value, equations.gradient);
  };
  // A step of the line delay moves the last row by hundreds of it.
  VectorXd unit = VectorXd::Ones(slam.columns().size());
  const CalibrationLayout& layout = fixture.calibration.layout;
  if (layout.line_delay() >= 0) {
    unit.tail(layout.size())[layout.line_delay()] = 1e-3;
  }
  const auto cost = [&](const VectorXd& steps) -> VectorXd {
    return VectorXd::Constant(1, reduce(unit.asDiagonal() * steps).first / 2);
  };
  const VectorXd gradient = unit.asDiagonal() * reduce(VectorXd::Zero(unit.size())).second;
  const VectorXd numeric = NumericJacobian(cost, static_cast<int>(unit.size()), 1e-4).transpose();
  EXPECT_LT((numeric - gradient).norm(), 1e-3 * gradient.norm());
  // A focal length's own, many orders below a rotation's.
  if (fixture.calibrated()) {
    EXPECT_LT((numeric - gradient).tail<4>().norm(), 1e-3 * gradient.tail<4>().norm());
  }
}

// The factor's cost is the minimum over the landmarks, so its gradient is that of the cost: no derivative of
// the landmarks is missing. So it is where the window has grown since the prior was made.
TEST_P(SlamPriorTest, ReducedSystemIsThatOfTheMinimumOverTheLandmarks) {
  for (const RobustKernel kernel :
       {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy, RobustKernel::kLogTail}) {
    for (const double growth : {1.0, 1.1}) {
      SCOPED_TRACE(testing::Message() << "kernel " << static_cast<int>(kernel) << ", growth " << growth);
      SlamFixture fixture = Fixture(7, {2, 4});
      const LinearPrior prior = fixture.Leave();
      ExpectGradient(fixture, prior, {kernel, 1.5}, growth);
    }
  }
}

// GIVEN a prior without landmarks, WHEN the window has grown since it was made THEN the reduced system is
// that of the prior's rows.
TEST_P(SlamPriorTest, WithoutLandmarksTheReducedSystemIsThatOfThePrior) {
  SlamFixture fixture = Fixture(7, {2, 4});
  fixture.change.after.clear();
  const LinearPrior prior = fixture.Leave();
  ASSERT_TRUE(prior.landmarks.empty());
  for (const double growth : {1.0, 1.1}) {
    SCOPED_TRACE(growth);
    ExpectGradient(fixture, prior, {}, growth);
  }
}

/// J^T J of the prior once a second frame has left, its last landmark refused if `refused`.
MatrixXd InformationAfterASecondLeft(SlamFixture* fixture, bool refused) {
  const LinearPrior prior = fixture->Leave();
  SlamChange change{PriorTracks(prior, fixture->window), {}, {}, true};
  if (refused) {
    change.before.back() = nullptr;
  }
  for (const WindowTrack* known : change.before) {
    if (known != nullptr) {
      WindowTrack& track = fixture->window.tracks().at(known->id);
      if (track.anchor->index == 0) {
        fixture->Anchor(track.anchor, &fixture->window.newest(), &track);
      }
      change.after.push_back(&track);
    }
  }
  const LinearPrior next =
      test::Marginalize(fixture->window, prior, fixture->NoVision(), {fixture->gravity_W}, change);
  return next.jacobian.transpose() * next.jacobian;
}

// GIVEN a landmark in the prior with the one view that has left, WHEN its track is refused THEN nothing else
// is known less or better: a view determines two of its three coordinates, and the third one takes no row
// along.
TEST_P(SlamPriorTest, ALandmarkRefusedAfterOneViewTellsNothing) {
  SlamFixture with = Fixture(7, {2, 4});
  SlamFixture without = Fixture(7, {2, 4});
  without.change.after.pop_back();
  const MatrixXd information = InformationAfterASecondLeft(&with, true);
  const MatrixXd expected = InformationAfterASecondLeft(&without, false);
  ASSERT_EQ(information.rows(), expected.rows());
  const VectorXd unit = expected.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd difference = unit.asDiagonal() * (information - expected) * unit.asDiagonal();
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6);
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

INSTANTIATE_TEST_SUITE_P(Conventions, SlamPriorTest, test::AllSlamFixtures(), test::NameOfSlamFixture);

}  // namespace
}  // namespace alidade
