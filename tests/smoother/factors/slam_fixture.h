#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "smoother/tracks/track_system.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/calibrated_window.h"
#include "tests/support/jacobian_checker.h"

namespace alidade::test {

/// Every camera `scale` times as far from the last one, and every velocity as much larger.
inline void Grow(double scale, const Eigen::Vector3d& camera_B, std::vector<NavState>* states) {
  const Eigen::Vector3d centre = states->back().T_WB() * camera_B;
  for (NavState& state : *states) {
    state.p_WB = centre + scale * (state.T_WB() * camera_B - centre) - state.R_WB * camera_B;
    state.v_WB *= scale;
  }
}

/// A window of which the oldest frame leaves: tracks that were based there become SLAM features, anchored in
/// the frames `anchors` gives in turn (indices before the frame left). With or without a calibration.
struct SlamFixture : WindowFixture {
  SlamFixture(unsigned seed, ErrorConvention error, bool calibrated, const std::vector<int>& anchors,
              FixtureView seen = FixtureView::kAhead, bool relative_to_spread = true)
      : WindowFixture(seed, 5, 12, calibrated && seen == FixtureView::kBehind ? 0.0 : 1.0, seen),
        convention(error) {
    EXPECT_TRUE(MakeInitialPrior(error, window.frame(0), 1e-3 * Matrix15d::Identity(), &first));
    if (calibrated) {
      const CalibrationEstimate estimate = CalibrateWindow(this);
      AddCalibrationPrior(estimate, &first);
      calibration = {estimate.layout, estimate.mean};
    }
    first.residual.setConstant(0.3);
    change.relative_to_spread = relative_to_spread;
    for (auto& [id, track] : window.tracks()) {
      if (track.views.front().frame->index == 0) {
        const int anchor = anchors[change.after.size() % anchors.size()];
        Anchor(track.views.front().frame, &window.frame(anchor), &track);
        change.after.push_back(&track);
      }
    }
  }
  [[nodiscard]] bool calibrated() const { return calibration.size() > 0; }
  [[nodiscard]] PoseSystem NoVision() const { return PoseSystem(window.size(), &calibration); }
  [[nodiscard]] std::vector<FrameGeometry> Geometry() const { return MakeGeometry(window, calibration.mean); }
  [[nodiscard]] CameraCalibration Moved(const Eigen::VectorXd& delta) const {
    CameraCalibration camera = calibration.mean;
    EXPECT_TRUE(Retract(calibration.layout, delta, &camera));
    return camera;
  }
  /// Geometry of a frame moved by a pose's error and the calibration's.
  [[nodiscard]] FrameGeometry MovedGeometry(const WindowFrame& frame, const Eigen::VectorXd& pose,
                                            const Eigen::VectorXd& camera) const {
    Vector9d xi = Vector9d::Zero();
    xi.head<6>() = pose;
    const NavState state = Retract(convention, frame.nav_state(), xi);
    return MakeGeometry(frame, state, Moved(camera));
  }
  /// The projection written once more, by points: whitened residual of a view over (anchor, view, landmark,
  /// calibration).
  [[nodiscard]] Eigen::VectorXd ViewResidual(const WindowTrack& track, const WindowView& view,
                                             const Eigen::VectorXd& delta) const {
    const auto camera_pose = [&](const WindowFrame& frame, const Eigen::VectorXd& pose,
                                 double row_px) -> Pose {
      Vector9d xi = Vector9d::Zero();
      xi.head<6>() = pose;
      Pose T_WB = Retract(convention, frame.nav_state(), xi).T_WB();
      if (!calibrated()) {
        return T_WB * T_BC;
      }
      const CameraCalibration camera = Moved(delta.tail(calibration.size()));
      const double later_s = camera.time_offset_s - frame.time_offset_s;
      T_WB.rotation = T_WB.rotation * so3::Exp(Eigen::Vector3d(later_s * frame.rates.head<3>()));
      T_WB.translation += later_s * frame.rates.tail<3>();
      return T_WB * frame.motion.After(*camera.line_delay_s * row_px) * camera.T_BC;
    };
    const Eigen::Vector3d l = track.landmark + delta.segment<3>(12);
    const Eigen::Vector3d on_plane(l.x() / l.z(), l.y() / l.z(), 1 / l.z());
    const Eigen::Vector3d p_W =
        camera_pose(*track.anchor, delta.head<6>(), 0) * Eigen::Vector3d(track.plane().axes() * on_plane);
    const Eigen::Vector3d p_C =
        camera_pose(*view.frame, delta.segment<6>(6), view.observation.row_px).Inverse() * p_W;
    if (!calibrated()) {
      const Eigen::Vector3d in_axes = view.observation.plane.axes().transpose() * p_C;
      return view.observation.sqrt_information * (in_axes.hnormalized() - view.observation.z);
    }
    Eigen::Vector2d pixel;
    EXPECT_TRUE(Moved(delta.tail(calibration.size())).camera.Project(p_C, &pixel));
    return pixel - view.pixel;  // a pixel of noise
  }
  void Anchor(const WindowFrame* from, const WindowFrame* to, WindowTrack* track) const {
    const std::vector<FrameGeometry> geometry = Geometry();
    FrameGeometry row;
    const FrameGeometry& before = track->anchor == nullptr ? AtRow(geometry, track->views.front(), &row)
                                                           : geometry[static_cast<size_t>(from->index)];
    const FrameGeometry& after = geometry[static_cast<size_t>(to->index)];
    const AnchorPlanes planes{track->plane(), PlaneInAnchor(before, track->plane(), after, track->landmark)};
    AnchorChange moved;
    ASSERT_TRUE(ChangeAnchor(before, after, track->landmark, &moved, {}, planes));
    track->landmark = moved.to;
    track->anchor = to;
    track->anchor_plane = planes.to;
  }
  LinearPrior Leave() {
    LinearPrior prior = Marginalize(window, first, NoVision(), {gravity_W}, change);
    window.RemoveOldest();
    return prior;
  }

  ErrorConvention convention;
  LinearPrior first;
  SlamChange change;
};

/// Dense normal equations over 15 coordinates of each frame, the calibration's, and 3 of each landmark.
struct DenseWindow {
  DenseWindow(const SlamFixture& of, size_t landmarks)
      : fixture(of), hessian(Eigen::MatrixXd::Zero(Landmark(landmarks), Landmark(landmarks))) {
    gradient.setZero(hessian.rows());
  }
  [[nodiscard]] Eigen::Index Calibration() const { return 15 * fixture.window.size(); }
  [[nodiscard]] Eigen::Index Landmark(size_t landmark) const {
    return Calibration() + fixture.calibration.size() + 3 * static_cast<Eigen::Index>(landmark);
  }

  void Add(const std::vector<Eigen::Index>& at, const std::vector<Eigen::Index>& width,
           const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual) {
    Eigen::MatrixXd full = Eigen::MatrixXd::Zero(jacobian.rows(), hessian.cols());
    Eigen::Index from = 0;
    for (size_t i = 0; i < at.size(); ++i) {
      full.middleCols(at[i], width[i]) += jacobian.middleCols(from, width[i]);
      from += width[i];
    }
    hessian += full.transpose() * full;
    gradient += full.transpose() * residual;
  }
  void AddView(const WindowTrack& track, const WindowView& view, size_t landmark) {
    const Eigen::Index size = 15 + fixture.calibration.size();
    const auto residual = [&](const Eigen::VectorXd& delta) {
      return fixture.ViewResidual(track, view, delta);
    };
    Eigen::MatrixXd jacobian = NumericJacobian(residual, static_cast<int>(size));
    if (track.anchor == view.frame) {  // both deltas move the same frame
      jacobian.leftCols<12>().setZero();
    }
    Add({15 * track.anchor->index, 15 * view.frame->index, Landmark(landmark), Calibration()},
        {6, 6, 3, fixture.calibration.size()}, jacobian, residual(Eigen::VectorXd::Zero(size)));
  }
  void AddImu() {
    const ImuRows imu = LinearizeImu(fixture.window.frame(0), fixture.window.frame(1), fixture.gravity_W);
    Eigen::Matrix<double, 15, 30> both;
    both << imu.first * ImuChartJacobian(fixture.convention, fixture.window.frame(0).nav_state()),
        imu.second * ImuChartJacobian(fixture.convention, fixture.window.frame(1).nav_state());
    Add({0, 15}, {15, 15}, both, imu.residual);
  }
  /// The prior of the window's first `frames` frames, with the landmarks it has.
  void AddPrior(const LinearPrior& prior, int frames, size_t landmarks) {
    std::vector<Eigen::Index> at, width;
    for (int i = 0; i < frames; ++i) {
      at.push_back(15 * i);
      width.push_back(i == 0 ? 15 : 6);
    }
    at.push_back(Calibration());
    width.push_back(fixture.calibration.size() + 3 * static_cast<Eigen::Index>(landmarks));
    Add(at, width, RowsAboutOrigin(prior), prior.residual);
  }
  /// Schur complement on the coordinates the prior of the next window has: frame 1 whole, poses of the
  /// others, calibration, the landmarks given.
  void KeepPrior(const std::vector<size_t>& landmarks) {
    std::vector<Eigen::Index> kept;
    const auto keep = [&](Eigen::Index first, Eigen::Index count) {
      for (Eigen::Index k = 0; k < count; ++k) {
        kept.push_back(first + k);
      }
    };
    for (Eigen::Index i = 1; i < fixture.window.size(); ++i) {
      keep(15 * i, i == 1 ? 15 : 6);
    }
    keep(Calibration(), fixture.calibration.size());
    for (const size_t landmark : landmarks) {
      keep(Landmark(landmark), 3);
    }
    std::vector<Eigen::Index> others;
    for (Eigen::Index i = 0; i < hessian.rows(); ++i) {
      if (std::find(kept.begin(), kept.end(), i) == kept.end() && hessian(i, i) > 0) {
        others.push_back(i);
      }
    }
    const Eigen::MatrixXd inverse = hessian(others, others).eval().inverse();
    const Eigen::MatrixXd schur =
        hessian(kept, kept) - hessian(kept, others) * inverse * hessian(others, kept);
    const Eigen::VectorXd reduced = gradient(kept) - hessian(kept, others) * inverse * gradient(others);
    hessian = schur;
    gradient = reduced;
  }

  const SlamFixture& fixture;
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};

/// Convention, with a calibration, where the camera looks, inverse depths relative to the spread.
using SlamFixtureKind = std::tuple<ErrorConvention, bool, FixtureView, bool>;

/// In every convention; with and without a calibration; ahead of the camera and behind it; with and without a
/// spread.
inline auto AllSlamFixtures() {
  return testing::Combine(testing::ValuesIn(kAllConventions), testing::Bool(),
                          testing::Values(FixtureView::kAhead, FixtureView::kBehind), testing::Bool());
}

inline std::string NameOfSlamFixture(const testing::TestParamInfo<SlamFixtureKind>& item) {
  return std::string(ToString(std::get<0>(item.param))) + (std::get<1>(item.param) ? "_calibrated" : "") +
         (std::get<2>(item.param) == FixtureView::kBehind ? "_behind" : "") +
         (std::get<3>(item.param) ? "" : "_metric");
}

class SlamFixtureTest : public testing::TestWithParam<SlamFixtureKind> {
 protected:
  [[nodiscard]] static ErrorConvention convention() { return std::get<0>(GetParam()); }
  [[nodiscard]] static SlamFixture Fixture(unsigned seed, const std::vector<int>& anchors) {
    return SlamFixture(seed, convention(), std::get<1>(GetParam()), anchors, std::get<2>(GetParam()),
                       std::get<3>(GetParam()));
  }
};

}  // namespace alidade::test
