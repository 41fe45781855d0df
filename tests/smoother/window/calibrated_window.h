#pragma once

#include <gtest/gtest.h>

#include "smoother/solve/vision_terms.h"
#include "smoother/window/window.h"
#include "smoother/window/window_calibration.h"
#include "tests/smoother/window/window_fixture.h"

namespace alidade::test {

/// A pinhole camera for the fixture, or double-sphere where it sees behind itself, all of whose calibration
/// is estimated: views keep their pixels, and the frames of the pinhole were placed by other time offsets
/// than the present one. It reads its rows out one after the other, ahead over 48 ms. Through a lens that is
/// not straight the rows over the intrinsics are exact at a residual of zero.
inline CalibrationEstimate CalibrateWindow(WindowFixture* fixture) {
  const Result<CameraModel> camera =
      fixture->seen_view == FixtureView::kAhead
          ? CameraModel::Create(DistortionModel::kNone, {458, 457, 367, 248}, {}, 752, 480)
          : CameraModel::Create(DistortionModel::kDoubleSphere, {100, 99, 367, 348}, {0.2, 0.5}, 752, 720);
  EXPECT_TRUE(camera.ok());
  CalibrationConfig config;
  config.extrinsics = config.time_offset = config.line_delay = config.intrinsics = true;
  for (int i = 0; i < fixture->window.size(); ++i) {
    WindowFrame& frame = fixture->window.frame(i);
    frame.time_offset_s = fixture->seen_view == FixtureView::kAhead ? 0.001 * i : 0.004;
    const NavState nav = frame.nav_state();
    frame.rates = BodyRates(fixture->random.Vector(1), nav.v_WB);
    frame.motion = {frame.rates.head<3>(), fixture->random.Vector(5), nav.R_WB.transpose() * nav.v_WB};
  }
  for (auto& [id, track] : fixture->window.tracks()) {
    for (WindowView& view : track.views) {
      EXPECT_TRUE(camera->Project(view.observation.Ray(), &view.pixel));
      EXPECT_TRUE(NormalizeObservation(*camera, view.pixel, 1.0, &view.observation));
    }
  }
  return InitialCalibration(
      config, {*camera, fixture->T_BC, 0.004, fixture->seen_view == FixtureView::kAhead ? 1e-4 : 0.0});
}

/// A window seen by a camera whose calibration is estimated.
struct CalibratedWindow : WindowFixture {
  explicit CalibratedWindow(unsigned seed, double noise_sigma = 1.0, int frames = 4, int landmarks = 12,
                            FixtureView seen = FixtureView::kAhead)
      : WindowFixture(seed, frames, landmarks, noise_sigma, seen) {
    estimate = CalibrateWindow(this);
    calibration = {estimate.layout, estimate.mean};
  }

  [[nodiscard]] PoseSystem Vision(int first_base, int last_base) const {
    const std::vector<FrameGeometry> geometry = MakeGeometry(window, calibration.mean);
    PoseSystem system(window.size(), &calibration);
    TrackWorkspace workspace;
    for (const WindowTrack* track : tracks()) {
      const int base = track->views.front().frame->index;
      if (base >= first_base && base <= last_base) {
        EXPECT_TRUE(AddTrack(track->views, geometry, {}, track->landmark, &workspace, &system));
      }
    }
    return system;
  }

  CalibrationEstimate estimate;
};

/// Of an initial state.
inline Matrix15d SomeCovariance() {
  Vector15d deviations;
  deviations << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.1),
      Eigen::Vector3d::Constant(0.2), Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.05);
  return deviations.cwiseAbs2().asDiagonal();
}

}  // namespace alidade::test
