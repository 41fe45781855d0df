#pragma once

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <memory>
#include <utility>
#include <vector>

#include "core/smoother_config.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_system.h"
#include "tests/integration/one_window.h"
#include "tests/support/fix_scenario.h"

namespace alidade::test {

/// The terms of a smoother's window, solved by Gauss-Newton without damping, by dense QR. Ceres stops short
/// of it: dogleg damps by 1e-8 of the diagonal, and a step that lowers the cost by less than a millionth is
/// not taken.
class TermSolution {
 public:
  TermSolution(const OneWindow& data, const EstimatorConfig& config, SmootherLandmark landmark)
      : landmark_(landmark), calibration_{{}, {data.rig.camera, data.rig.T_BC, 0}} {
    for (const TrackFrame& frame : data.frames) {
      AddFrame(data, frame.stamp_ns);
      EXPECT_EQ(window_.AddObservations(data.rig.camera, config.vision.pixel_noise_px, frame.observations),
                0);
      AttachFixes(data, config.fix, &window_.newest());
    }
    const NavEstimate start =
        data.fixes.empty() ? data.start : TurnIntoEnu(IdentityAlignment(data.start.stamp_ns), data.start);
    EXPECT_TRUE(MakeInitialPrior(config.smoother.error, window_.frame(0), start.covariance, &prior_));
    for (auto& [id, track] : window_.tracks()) {
      EXPECT_TRUE(InitializeLandmark(track.views, MakeGeometry(window_, data.rig.T_BC), 1, &track.landmark));
      tracks_.push_back(&track);
    }
    constexpr int kSteps = 4;  // the errors are small: each step squares what is left
    for (int i = 0; i < kSteps; ++i) {
      Step();
    }
  }

  [[nodiscard]] NavEstimate Newest() const {
    const WindowFrame& newest = window_.newest();
    return {newest.stamp_ns, newest.nav_state(), newest.imu_bias(), covariance_};
  }

 private:
  /// At the start, or where the IMU leads from the frame before.
  void AddFrame(const OneWindow& data, TimeNs stamp_ns) {
    auto frame = std::make_unique<WindowFrame>();
    NavEstimate state = data.start;
    if (window_.size() > 0) {
      const WindowFrame& from = window_.newest();
      for (const ImuSample& sample : data.samples) {
        if (sample.stamp_ns >= from.stamp_ns && sample.stamp_ns <= stamp_ns) {
          frame->imu.push_back(sample);
        }
      }
      UpdatePreintegration(from, data.rig.imu_noise, frame.get());
      state.nav = CarryState(*frame->preintegration, from.nav_state(), from.imu_bias(), gravity_W_, nullptr);
    }
    frame->stamp_ns = stamp_ns;
    PackNavState(state.nav, frame->nav.data());
    PackBias(state.bias, frame->bias.data());
    window_.AddFrame(std::move(frame));
  }

  static void AttachFixes(const OneWindow& data, const FixConfig& config, WindowFrame* frame) {
    for (const PositionFix& fix : data.fixes) {
      if (fix.stamp_ns == frame->stamp_ns) {
        FrameMeasurement& attached = frame->measurements.emplace_back();
        attached.measurement = *MakeFixMeasurement(config, data.rig.fixes, fix);
        attached.Set({}, frame->imu_bias(), data.rig.imu_noise);
      }
    }
  }

  [[nodiscard]] WindowTerms MakeTerms() const {
    WindowTerms terms;
    terms.push_back(MakePriorTerm(prior_, calibration_));
    EXPECT_TRUE(AddSensorTerms({gravity_W_}, window_.frames(), window_.size(), &terms).ok());
    if (landmark_ == SmootherLandmark::kInverseDepth) {
      AddTrackTerms(window_.frames(), tracks_, calibration_, {}, &terms);
    } else {
      terms.push_back(std::make_unique<PoseOnlyTerm>(
          window_, std::vector<const WindowTrack*>(tracks_.begin(), tracks_.end()), calibration_,
          ObservationKernel{}));
    }
    return terms;
  }

  /// Columns of the landmarks, then of the states.
  [[nodiscard]] ColumnMap Columns() const {
    ColumnMap columns;
    for (int i = 0; landmark_ == SmootherLandmark::kInverseDepth && i < kTracks; ++i) {
      columns.AddLandmark(i);
    }
    for (int i = 0; i < window_.size(); ++i) {
      columns.AddState(i);
    }
    return columns;
  }

  void Step() {
    for (WindowTrack* track : tracks_) {
      EXPECT_TRUE(
          SolveLandmark(track->views, MakeGeometry(window_, calibration_.mean), {}, 30, &track->landmark));
    }
    const ColumnMap columns = Columns();
    Eigen::MatrixXd rows(0, columns.size());
    Eigen::VectorXd residual(0);
    for (const std::unique_ptr<WindowTerm>& term : MakeTerms()) {
      LinearTerm linear;
      EXPECT_TRUE(term->Linearize(&linear).ok());
      linear.MakeRows();
      const Eigen::Index first = rows.rows();
      rows.conservativeResize(first + linear.residual.size(), Eigen::NoChange);
      rows.bottomRows(linear.residual.size()).setZero();
      for (const TermPart& part : linear.parts) {
        rows.block(first, columns.Find(part.of).first, linear.residual.size(), part.width) =
            linear.jacobian.middleCols(part.first, part.width);
      }
      residual.conservativeResize(rows.rows());
      residual.tail(linear.residual.size()) = linear.residual;
    }
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(rows);
    Move(columns, qr.solve(-residual));
    const Matrix15d root =
        qr.matrixQR().topRows(columns.size()).bottomRightCorner<15, 15>().triangularView<Eigen::Upper>();
    const Matrix15d inverse = root.triangularView<Eigen::Upper>().solve(Matrix15d::Identity());
    covariance_ = inverse * inverse.transpose();
  }

  void Move(const ColumnMap& columns, const Eigen::VectorXd& step) {
    for (int i = 0; i < window_.size(); ++i) {
      WindowFrame& frame = window_.frame(i);
      const Vector15d own = step.segment<15>(columns.Frame(i).first);
      PackNavState(Retract(ErrorConvention::kSo3xRn, frame.nav_state(), Vector9d(own.head<9>())),
                   frame.nav.data());
      const ImuBias bias = frame.imu_bias();
      PackBias({bias.gyro + own.segment<3>(9), bias.accel + own.tail<3>()}, frame.bias.data());
    }
  }

  SmootherLandmark landmark_;
  WindowCalibration calibration_;
  Eigen::Vector3d gravity_W_ = GravityInWorld(kGravity);
  Window window_;
  LinearPrior prior_;
  std::vector<WindowTrack*> tracks_;
  Matrix15d covariance_;
};

}  // namespace alidade::test
