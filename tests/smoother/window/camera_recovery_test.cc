#include <gtest/gtest.h>

#include <cmath>

#include "core/reprojection.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_solver.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/calibrated_window.h"

namespace alidade {
namespace {

using Eigen::VectorXd;

/// GIVEN exact data and a camera that is given wrong and hardly trusted, WHEN the window is solved, THEN the
/// right one is found.
class CameraRecoveryTest : public testing::Test {
 protected:
  void SetUp() override {
    CalibrationConfig config;
    config.extrinsics = config.time_offset = true;
    config.rotation_std_rad = config.translation_std_m = config.time_offset_std_s = 1e4;
    fixture_.estimate = InitialCalibration(config, fixture_.estimate.mean);
    fixture_.calibration.layout = fixture_.estimate.layout;
    truth_ = fixture_.calibration.mean;
    geometry_ = MakeGeometry(fixture_.window, truth_);
    SeeExactly();
    ASSERT_TRUE(MakeInitialPrior(ErrorConvention::kRightInvariant, fixture_.window.frame(0),
                                 test::SomeCovariance(), &prior_));
    AddCalibrationPrior(fixture_.estimate, &prior_);
  }

  /// Tracks of the oldest frame become landmarks of the prior, and the frame leaves.
  void MakeFeatures() {
    SlamChange change;
    for (auto& [id, track] : fixture_.window.tracks()) {
      AnchorChange moved;
      FrameGeometry row;
      if (track.views.front().frame->index == 0 && ChangeAnchor(AtRow(geometry_, track.views.front(), &row),
                                                                geometry_.back(), track.landmark, &moved)) {
        track.landmark = moved.to;
        track.anchor = &fixture_.window.newest();
        change.after.push_back(&track);
      }
    }
    prior_ =
        test::Marginalize(fixture_.window, prior_, PoseSystem(fixture_.window.size(), &fixture_.calibration),
                          {fixture_.gravity_W}, change);
    fixture_.window.RemoveOldest();
    ASSERT_GT(prior_.landmarks.size(), 10u);
  }

  void ExpectRecovery(LandmarkMotion motion) {
    VectorXd wrong(7);
    wrong << 0.02, -0.02, 0.02, 0.01, -0.01, 0.015, 0.01;
    ASSERT_TRUE(Retract(fixture_.calibration.layout, wrong, &fixture_.calibration.mean));
    SmootherConfig config;
    config.max_iterations = 50;
    std::vector<const WindowTrack*> tracks;
    for (const auto& [id, track] : fixture_.window.tracks()) {
      if (track.anchor == nullptr) {
        tracks.push_back(&track);
      }
    }
    const WindowTerms terms = Terms(motion, tracks);
    const auto solve = [&](double remaining_sigma) {
      return SolveWindow(config, terms, &fixture_.window, &fixture_.calibration, remaining_sigma);
    };
    const Result<WindowSolveReport> near = solve(kRemainingSigma);
    ASSERT_TRUE(near.ok()) << near.message();
    const Result<WindowSolveReport> report = solve(0);
    ASSERT_TRUE(report.ok()) << report.message();
    EXPECT_GT(near->initial_cost, 1);
    EXPECT_LT(near->final_cost - report->final_cost, 0.5 * kRemainingSigma * kRemainingSigma);
    const VectorXd error = Local(fixture_.calibration.layout, truth_, fixture_.calibration.mean);
    EXPECT_LT(error.head<3>().norm(), 1e-4);
    EXPECT_LT(error.segment<3>(3).norm(), 1e-3);
    EXPECT_LT(std::abs(error[6]), 1e-4);
  }

 private:
  void SeeExactly() {
    for (auto& [id, track] : fixture_.window.tracks()) {
      for (WindowView& view : track.views) {
        FrameGeometry base_row, view_row;
        const AnchoredPointInCamera seen(AtRow(geometry_, track.views.front(), &base_row).T_WC,
                                         AtRow(geometry_, view, &view_row).T_WC, track.landmark);
        view.observation.z = seen.q.hnormalized();
      }
    }
  }

  WindowTerms Terms(LandmarkMotion motion, const std::vector<const WindowTrack*>& tracks) {
    WindowTerms terms;
    if (prior_.landmarks.empty()) {
      terms.push_back(MakePriorTerm(prior_, fixture_.calibration));
    } else {
      terms.push_back(std::make_unique<SlamPriorTerm>(prior_, fixture_.window, fixture_.calibration,
                                                      ObservationKernel{}));
    }
    EXPECT_TRUE(
        AddSensorTerms({fixture_.gravity_W}, fixture_.window.frames(), fixture_.window.size(), &terms).ok());
    const VisionConfig vision;
    const ObservationKernel kernel{vision.robust_kernel, vision.robust_scale_sigma};
    terms.push_back(
        std::make_unique<PoseOnlyTerm>(fixture_.window, tracks, fixture_.calibration, kernel, motion));
    return terms;
  }

  test::CalibratedWindow fixture_{21, 0.0, 8, 40};
  CameraCalibration truth_;
  std::vector<FrameGeometry> geometry_;
  LinearPrior prior_;
};

TEST_F(CameraRecoveryTest, PoseOnlyLandmarksRecoverTheCamera) {
  ExpectRecovery(LandmarkMotion::kSolved);
}
TEST_F(CameraRecoveryTest, InverseDepthsRecoverTheCamera) {
  ExpectRecovery(LandmarkMotion::kJointStep);
}
TEST_F(CameraRecoveryTest, FeaturesOfThePriorRecoverTheCamera) {
  MakeFeatures();
  ExpectRecovery(LandmarkMotion::kSolved);
}

}  // namespace
}  // namespace alidade
