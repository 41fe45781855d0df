#include "smoother/slam_prior.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "smoother/frame_rows.h"
#include "smoother/marginalization.h"
#include "smoother/slam_prior_factor.h"
#include "tests/smoother/window_fixture.h"
#include "tests/support/jacobian_checker.h"

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::CompareJacobians;
using test::kAllConventions;
using test::NumericJacobian;
using test::WindowFixture;

FrameGeometry MovedGeometry(ErrorConvention convention, const WindowFrame& frame, const VectorXd& pose,
                            const Pose& T_BC) {
  Vector9d xi = Vector9d::Zero();
  xi.head<6>() = pose;
  return MakeGeometry(Retract(convention, frame.nav_state(), xi), T_BC);
}

/// The projection written once more, by points: whitened residual of a view over (anchor, view, landmark).
VectorXd ViewResidual(ErrorConvention convention, const WindowTrack& track, const WindowView& view,
                      const Pose& T_BC, const VectorXd& delta) {
  const Pose anchor = MovedGeometry(convention, *track.anchor, delta.head<6>(), T_BC).T_WC;
  const Pose seen = MovedGeometry(convention, *view.frame, delta.segment<6>(6), T_BC).T_WC;
  const Vector3d l = track.landmark + delta.tail<3>();
  const Vector3d p_W = anchor * Vector3d(l.x() / l.z(), l.y() / l.z(), 1 / l.z());
  const Vector3d p_C = seen.Inverse() * p_W;
  return view.observation.sqrt_information * (p_C.hnormalized() - view.observation.z);
}

/// Dense normal equations over 15 coordinates of each frame and 3 of each landmark, in the order given.
struct Dense {
  Dense(const Window& window, size_t landmarks)
      : frames(window.size()), hessian(MatrixXd::Zero(Size(landmarks), Size(landmarks))) {
    gradient.setZero(hessian.rows());
  }
  [[nodiscard]] Index Size(size_t landmarks) const { return 15 * frames + 3 * static_cast<Index>(landmarks); }

  void Add(const std::vector<Index>& at, const std::vector<Index>& width, const MatrixXd& jacobian,
           const VectorXd& residual) {
    MatrixXd full = MatrixXd::Zero(jacobian.rows(), hessian.cols());
    Index from = 0;
    for (size_t i = 0; i < at.size(); ++i) {
      full.middleCols(at[i], width[i]) += jacobian.middleCols(from, width[i]);
      from += width[i];
    }
    hessian += full.transpose() * full;
    gradient += full.transpose() * residual;
  }
  void AddView(ErrorConvention convention, const WindowTrack& track, const WindowView& view, size_t landmark,
               const Pose& T_BC) {
    const auto residual = [&](const VectorXd& delta) {
      return ViewResidual(convention, track, view, T_BC, delta);
    };
    MatrixXd jacobian = NumericJacobian(residual, 15);
    if (track.anchor == view.frame) {  // both deltas move the same frame
      jacobian.leftCols<12>().setZero();
    }
    Add({15 * track.anchor->index, 15 * view.frame->index, Size(landmark)}, {6, 6, 3}, jacobian,
        residual(VectorXd::Zero(15)));
  }
  void AddImu(ErrorConvention convention, const Window& window, const Vector3d& gravity_W) {
    const ImuRows imu = LinearizeImu(window.frame(0), window.frame(1), gravity_W);
    Eigen::Matrix<double, 15, 30> both;
    both << imu.first * ImuChartJacobian(convention, window.frame(0).nav_state()),
        imu.second * ImuChartJacobian(convention, window.frame(1).nav_state());
    Add({0, 15}, {15, 15}, both, imu.residual);
  }
  /// Schur complement of the coordinates that are not in `kept`.
  void Keep(const std::vector<Index>& kept) {
    std::vector<Index> others;
    for (Index i = 0; i < hessian.rows(); ++i) {
      if (std::find(kept.begin(), kept.end(), i) == kept.end() && hessian(i, i) > 0) {
        others.push_back(i);
      }
    }
    const MatrixXd inverse = hessian(others, others).eval().inverse();
    const MatrixXd schur = hessian(kept, kept) - hessian(kept, others) * inverse * hessian(others, kept);
    const VectorXd reduced = gradient(kept) - hessian(kept, others) * inverse * gradient(others);
    hessian = schur;
    gradient = reduced;
  }

  Index frames;
  MatrixXd hessian;
  VectorXd gradient;
};

/// Coordinates the prior of the next window has: frame 1 whole, poses of the others, landmarks.
std::vector<Index> PriorCoordinates(Index frames, const std::vector<size_t>& landmarks) {
  std::vector<Index> kept;
  for (Index i = 1; i < frames; ++i) {
    for (Index k = 0; k < (i == 1 ? 15 : 6); ++k) {
      kept.push_back(15 * i + k);
    }
  }
  for (const size_t landmark : landmarks) {
    for (Index k = 0; k < 3; ++k) {
      kept.push_back(15 * frames + 3 * static_cast<Index>(landmark) + k);
    }
  }
  return kept;
}

void ExpectPrior(const LinearPrior& prior, const Dense& dense) {
  ASSERT_EQ(prior.columns(), dense.hessian.rows());
  const MatrixXd information = prior.jacobian.transpose() * prior.jacobian;
  EXPECT_LT((information - dense.hessian).norm(), 1e-6 * dense.hessian.norm());
  const VectorXd gradient = prior.jacobian.transpose() * prior.residual;
  EXPECT_LT((gradient - dense.gradient).norm(), 1e-6 * dense.gradient.norm());
}

/// A window of which the oldest frame has left: tracks that were based there are SLAM features, anchored in
/// the frames `anchors` gives in turn (indices before the frame left).
struct SlamFixture : WindowFixture {
  SlamFixture(unsigned seed, ErrorConvention error, const std::vector<int>& anchors)
      : WindowFixture(seed, 5, 12, 1.0), convention(error) {
    EXPECT_TRUE(MakeInitialPrior(error, window.frame(0), 1e-3 * Matrix15d::Identity(), &first));
    first.residual = Vector15d::Constant(0.3);
    change.T_BC = T_BC;
    const std::vector<FrameGeometry> geometry = MakeGeometry(window, T_BC);
    for (auto& [id, track] : window.tracks()) {
      if (track.views.front().frame->index == 0) {
        const int anchor = anchors[change.after.size() % anchors.size()];
        Anchor(geometry, track.views.front().frame, &window.frame(anchor), &track);
        change.after.push_back(&track);
      }
    }
  }
  static void Anchor(const std::vector<FrameGeometry>& geometry, const WindowFrame* from,
                     const WindowFrame* to, WindowTrack* track) {
    AnchorChange moved;
    ASSERT_TRUE(ChangeAnchor(geometry[static_cast<size_t>(from->index)],
                             geometry[static_cast<size_t>(to->index)], track->landmark, &moved));
    track->landmark = moved.to;
    track->anchor = to;
  }
  LinearPrior Leave() {
    LinearPrior prior =
        MarginalizeOldest(window, first, PoseSystem(window.size()), gravity_W, nullptr, change);
    window.RemoveOldest();
    return prior;
  }

  ErrorConvention convention;
  LinearPrior first;
  SlamChange change;
};

class SlamPriorTest : public testing::TestWithParam<ErrorConvention> {};

TEST_P(SlamPriorTest, RowsOfAnAnchoredViewAgainstDifferences) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SlamFixture fixture(seed, GetParam(), {3, 4});
    const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
    for (const WindowTrack* track : fixture.change.after) {
      const WindowView& view = track->views[1];
      AnchoredRows rows;
      ASSERT_TRUE(LinearizeAnchoredView(geometry[static_cast<size_t>(track->anchor->index)],
                                        geometry[static_cast<size_t>(view.frame->index)], view.observation,
                                        {}, track->landmark, &rows));
      Eigen::Matrix<double, 2, 15> analytic;
      analytic << rows.anchor * ChartJacobian(GetParam(), track->anchor->nav_state().T_WB()),
          rows.view * ChartJacobian(GetParam(), view.frame->nav_state().T_WB()), rows.landmark;
      const auto residual = [&](const VectorXd& delta) {
        return ViewResidual(GetParam(), *track, view, fixture.T_BC, delta);
      };
      EXPECT_EQ(CompareJacobians(analytic, NumericJacobian(residual, 15), 1e-6), "");
      EXPECT_LT((rows.residual - residual(VectorXd::Zero(15))).norm(), 1e-9);
    }
  }
}

TEST_P(SlamPriorTest, ChangeOfAnchorAgainstDifferences) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SlamFixture fixture(seed, GetParam(), {3});
    const WindowTrack& track = *fixture.change.after.front();
    const WindowFrame& from = *track.anchor;
    const WindowFrame& to = fixture.window.frame(1);
    const auto geometry = [&](const WindowFrame& frame, const VectorXd& pose) {
      return MovedGeometry(GetParam(), frame, pose, fixture.T_BC);
    };
    AnchorChange change;
    const VectorXd none = VectorXd::Zero(6);
    ASSERT_TRUE(ChangeAnchor(geometry(from, none), geometry(to, none), track.landmark, &change));
    const auto old_coordinates = [&](const VectorXd& delta) -> VectorXd {
      AnchorChange back;
      EXPECT_TRUE(ChangeAnchor(geometry(to, delta.segment<6>(6)), geometry(from, delta.head<6>()),
                               change.to + delta.tail<3>(), &back));
      return back.to;
    };
    EXPECT_LT((old_coordinates(VectorXd::Zero(15)) - track.landmark).norm(), 1e-12);
    Eigen::Matrix<double, 3, 15> analytic;
    analytic << change.from_frame * ChartJacobian(GetParam(), from.nav_state().T_WB()),
        change.to_frame * ChartJacobian(GetParam(), to.nav_state().T_WB()), change.landmark;
    EXPECT_EQ(CompareJacobians(analytic, NumericJacobian(old_coordinates, 15), 1e-6), "");
  }
}

// GIVEN tracks that keep their landmarks, WHEN their oldest frame leaves, THEN the prior is the Schur
// complement over prior, IMU and their views in that frame; no other view is used up.
TEST_P(SlamPriorTest, NewFeaturesGiveTheSchurComplement) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SlamFixture fixture(seed, GetParam(), {3, 4});
    const size_t count = fixture.change.after.size();
    ASSERT_GT(count, 3u);
    Dense dense(fixture.window, count);
    dense.AddImu(GetParam(), fixture.window, fixture.gravity_W);
    dense.Add({0}, {15}, fixture.first.jacobian, fixture.first.residual);
    std::vector<size_t> all;
    for (size_t i = 0; i < count; ++i) {
      const WindowTrack& track = *fixture.change.after[i];
      dense.AddView(GetParam(), track, track.views.front(), i, fixture.T_BC);
      all.push_back(i);
    }
    dense.Keep(PriorCoordinates(5, all));
    ExpectPrior(fixture.Leave(), dense);
  }
}

// GIVEN a prior with landmarks, WHEN its oldest frame leaves, THEN a landmark anchored there is expressed in
// another frame and a lost one is eliminated with all of its views, nothing else being lost.
TEST_P(SlamPriorTest, AnchorsThatLeaveAndLostFeaturesGiveTheSchurComplement) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SlamFixture fixture(seed, GetParam(), {1, 4});
    LinearPrior prior = fixture.Leave();
    std::vector<const WindowTrack*> tracks = PriorTracks(prior, fixture.window);
    const size_t count = tracks.size();
    const size_t lost = 1;
    const Index frames = fixture.window.size();
    Dense dense(fixture.window, count);
    dense.AddImu(GetParam(), fixture.window, fixture.gravity_W);
    std::vector<Index> at, width;
    for (Index i = 0; i < frames; ++i) {
      at.push_back(15 * i);
      width.push_back(i == 0 ? 15 : 6);
    }
    at.push_back(15 * frames);
    width.push_back(3 * static_cast<Index>(count));
    dense.Add(at, width, prior.jacobian, prior.residual);
    std::vector<size_t> staying;
    for (size_t i = 0; i < count; ++i) {
      for (const WindowView& view : tracks[i]->views) {
        if (i == lost || view.frame->index == 0) {
          dense.AddView(GetParam(), *tracks[i], view, i, fixture.T_BC);
        }
      }
      if (i != lost) {
        staying.push_back(i);
      }
    }
    // The landmarks' new coordinates, by differences of the change of anchor.
    MatrixXd substitute = MatrixXd::Identity(dense.hessian.rows(), dense.hessian.cols());
    const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
    SlamChange change{tracks, {}, fixture.T_BC, {}};
    for (const size_t i : staying) {
      WindowTrack& track = fixture.window.tracks().at(tracks[i]->id);
      change.after.push_back(&track);
      if (track.anchor->index > 0) {
        continue;
      }
      const WindowFrame& from = *track.anchor;
      const WindowFrame& to = fixture.window.newest();
      SlamFixture::Anchor(geometry, &from, &to, &track);
      const auto old_coordinates = [&](const VectorXd& delta) -> VectorXd {
        AnchorChange back;
        EXPECT_TRUE(ChangeAnchor(MovedGeometry(GetParam(), to, delta.segment<6>(6), fixture.T_BC),
                                 MovedGeometry(GetParam(), from, delta.head<6>(), fixture.T_BC),
                                 track.landmark + delta.tail<3>(), &back));
        return back.to;
      };
      const MatrixXd jacobian = NumericJacobian(old_coordinates, 15);
      const Index row = dense.Size(i);
      substitute.block<3, 6>(row, 0) = jacobian.leftCols<6>();
      substitute.block<3, 6>(row, 15 * (frames - 1)) = jacobian.middleCols<6>(6);
      substitute.block<3, 3>(row, row) = jacobian.rightCols<3>();
    }
    dense.hessian = (substitute.transpose() * dense.hessian * substitute).eval();
    dense.gradient = (substitute.transpose() * dense.gradient).eval();
    dense.Keep(PriorCoordinates(frames, staying));
    ExpectPrior(MarginalizeOldest(fixture.window, prior, PoseSystem(fixture.window.size()), fixture.gravity_W,
                                  nullptr, change),
                dense);
  }
}

// The factor's cost is the minimum over the landmarks, so its gradient is that of the cost: no derivative of
// the landmarks is missing; and its rows are its gradient and its Gauss-Newton matrix.
TEST_P(SlamPriorTest, ReducedSystemIsThatOfTheMinimumOverTheLandmarks) {
  for (const RobustKernel kernel : {RobustKernel::kNone, RobustKernel::kHuber, RobustKernel::kCauchy}) {
    SlamFixture fixture(7, GetParam(), {2, 4});
    const LinearPrior prior = fixture.Leave();
    const int frames = fixture.window.size();
    const SlamPrior slam(&prior, PriorTracks(prior, fixture.window), fixture.T_BC, {kernel, 1.5}, frames);
    const WindowPoint origin = PointOf(fixture.window);
    const auto reduce = [&](const VectorXd& zeta) {
      WindowPoint point = origin;
      for (int i = 0; i < frames; ++i) {
        Vector9d xi = Vector9d::Zero();
        xi.head(i == 0 ? 9 : 6) = zeta.segment(SlamPrior::Column(i), i == 0 ? 9 : 6);
        point.states[static_cast<size_t>(i)] =
            Retract(ErrorConvention::kSo3xRn, origin.states[static_cast<size_t>(i)], xi);
      }
      point.bias.gyro += zeta.segment<3>(9);
      point.bias.accel += zeta.segment<3>(12);
      VectorXd landmarks = slam.StartingLandmarks();
      SlamPrior::Reduced reduced;
      for (int k = 0; k < 4; ++k) {  // re-weighting converges linearly
        EXPECT_TRUE(slam.Reduce(point, &landmarks, &reduced));
      }
      return reduced;
    };
    const SlamPrior::Reduced at = reduce(VectorXd::Zero(slam.columns()));
    const auto cost = [&](const VectorXd& zeta) -> VectorXd {
      return VectorXd::Constant(1, reduce(zeta).robust_cost / 2);
    };
    const MatrixXd numeric = NumericJacobian(cost, slam.columns(), 1e-4);
    EXPECT_LT((numeric.transpose() - at.gradient).norm(), 1e-3 * at.gradient.norm())
        << static_cast<int>(kernel);
  }
}

// Yaw and position of the whole window are unknown to vision and IMU, and stay so in the prior.
TEST(SlamPriorGaugeTest, NothingIsLearntOfYawAndPosition) {
  SlamFixture fixture(8, ErrorConvention::kRightInvariant, {1, 4});
  fixture.first.jacobian.setZero();
  LinearPrior prior = fixture.Leave();
  for (int leave = 0; leave < 2; ++leave) {
    MatrixXd gauge = MatrixXd::Zero(prior.columns(), 4);
    for (int i = 0; i < static_cast<int>(prior.anchors.size()); ++i) {
      gauge(LinearPrior::Column(i) + 2, 0) = 1;
      gauge.block<3, 3>(LinearPrior::Column(i) + 3, 1).setIdentity();
    }
    EXPECT_LT((prior.jacobian * gauge).norm(), 1e-6 * prior.jacobian.norm());
    // Once more, with anchors that leave.
    const std::vector<FrameGeometry> geometry = MakeGeometry(fixture.window, fixture.T_BC);
    SlamChange change{PriorTracks(prior, fixture.window), {}, fixture.T_BC, {}};
    for (const WindowTrack* known : change.before) {
      WindowTrack& track = fixture.window.tracks().at(known->id);
      if (track.anchor->index == 0) {
        SlamFixture::Anchor(geometry, track.anchor, &fixture.window.newest(), &track);
      }
      change.after.push_back(&track);
    }
    prior = MarginalizeOldest(fixture.window, prior, PoseSystem(fixture.window.size()), fixture.gravity_W,
                              nullptr, change);
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, SlamPriorTest, testing::ValuesIn(kAllConventions),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade
