#pragma once

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <memory>
#include <utility>
#include <vector>

#include "core/smoother_config.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/sliding/gnss_window.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_system.h"
#include "tests/integration/one_window.h"

namespace alidade::test {

/// The terms of a smoother's window, solved by Gauss-Newton without damping, by dense QR. Ceres stops short
/// of it: dogleg damps by 1e-8 of the diagonal, and a step that lowers the cost by less than a millionth is
/// not taken.
class TermSolution {
 public:
  TermSolution(const OneWindow& data, const EstimatorConfig& config, SmootherLandmark landmark)
      : landmark_(landmark), gnss_(config.gnss, data.rig.gnss, gravity_W_) {
    for (const TrackFrame& frame : data.frames) {
      AddFrame(data, frame.stamp_ns);
      if (window_.size() == 1) {
        MakePrior(data, config);
      }
      EXPECT_EQ(window_.AddObservations(data.rig.camera, PixelNoise(config.vision), frame.observations), 0);
      AttachMeasurements(data, config.fix, &window_.newest());
    }
    window_.UpdateRates();
    for (auto& [id, track] : window_.tracks()) {
      EXPECT_TRUE(
          InitializeLandmark(track.views, MakeGeometry(window_, calibration_.mean), 1, &track.landmark));
      tracks_.push_back(&track);
    }
    constexpr int kSteps = 4;  // the errors are small: each step squares what is left
    for (int i = 0; i < kSteps; ++i) {
      Step();
    }
  }

  [[nodiscard]] NavEstimate Newest() const {
    const WindowFrame& newest = window_.newest();
    return {newest.stamp_ns, newest.nav_state(), newest.imu_bias(), covariance_.bottomRightCorner<15, 15>()};
  }
  /// Precondition: the window has epochs.
  [[nodiscard]] ClockState Clock() const {
    const Eigen::Index first = covariance_.rows() - 15 - kClockColumns;
    return {window_.newest().clock_state(), covariance_.block<kClockColumns, kClockColumns>(first, first)};
  }
  [[nodiscard]] CalibrationEstimate Calibration() const {
    return {calibration_.layout, calibration_.mean,
            covariance_.diagonal().head(calibration_.size()).cwiseSqrt()};
  }

 private:
  void MakePrior(const OneWindow& data, const EstimatorConfig& config) {
    const NavEstimate start = data.alignment ? TurnIntoEnu(*data.alignment, data.start) : data.start;
    EXPECT_TRUE(MakeInitialPrior(config.smoother.error, window_.frame(0), start.covariance, &prior_));
    if (data.alignment && data.alignment->clock) {
      gnss_.Align(*data.alignment, &window_.frame(0), &prior_);
    }
    const CalibrationEstimate given =
        InitialCalibration(config.calibration, GivenCamera(data.rig, config.vision));
    calibration_ = {given.layout, given.mean};
    AddCalibrationPrior(given, &prior_);
  }

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
    frame->turn = TurnAround(data.samples, stamp_ns, 0);
    if (window_.size() > 0) {
      gnss_.PredictClock(window_.newest(), frame.get());
    }
    PackNavState(state.nav, frame->nav.data());
    PackBias(state.bias, frame->bias.data());
    window_.AddFrame(std::move(frame));
  }

  void AttachMeasurements(const OneWindow& data, const FixConfig& config, WindowFrame* frame) {
    for (const PositionFix& fix : data.fixes) {
      if (fix.stamp_ns == frame->stamp_ns) {
        FrameMeasurement& attached = frame->measurements.emplace_back();
        attached.measurement = *MakeFixMeasurement(config, data.rig.fixes, fix);
        attached.Set({}, frame->imu_bias(), data.rig.imu_noise);
      }
    }
    for (const GnssEpoch& epoch : data.epochs) {
      if (epoch.stamp_ns == frame->stamp_ns) {
        EXPECT_TRUE(gnss_.Attach(epoch, {frame->imu.back()}, data.rig.imu_noise, frame));
      }
    }
  }

  [[nodiscard]] WindowTerms MakeTerms() const {
    WindowTerms terms;
    terms.push_back(MakePriorTerm(prior_, calibration_));
    EXPECT_TRUE(
        AddSensorTerms({gravity_W_, gnss_.context(), &calibration_}, window_.frames(), window_.size(), &terms)
            .ok());
    if (landmark_ == SmootherLandmark::kInverseDepth) {
      AddTrackTerms(window_.frames(), tracks_, calibration_, {}, &terms);
    } else {
      terms.push_back(std::make_unique<PoseOnlyTerm>(
          window_, std::vector<const WindowTrack*>(tracks_.begin(), tracks_.end()), calibration_,
          ObservationKernel{}));
    }
    return terms;
  }

  /// Columns of the landmarks and of the older frames, then of calibration, newest clock and newest state.
  [[nodiscard]] ColumnMap Columns() const {
    ColumnMap columns;
    for (int i = 0; landmark_ == SmootherLandmark::kInverseDepth && i < kTracks; ++i) {
      columns.AddLandmark(i);
    }
    const int newest = window_.size() - 1;
    for (int i = 0; i <= newest; ++i) {
      if (i == newest) {
        columns.AddCalibration(calibration_.size());
      }
      if (gnss_.aligned()) {
        columns.AddClock(i);
      }
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
    const Eigen::Index known = calibration_.size() + (gnss_.aligned() ? kClockColumns : 0) + kStateColumns;
    const Eigen::MatrixXd root = qr.matrixQR().topRows(columns.size()).bottomRightCorner(known, known);
    const Eigen::MatrixXd inverse =
        root.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(known, known));
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
      if (gnss_.aligned()) {
        Eigen::Map<Vector6d>{frame.clock->data()} += step.segment<kClockColumns>(columns.Clock(i).first);
      }
    }
    const ColumnMap::Range camera = columns.Calibration();
    EXPECT_TRUE(Retract(calibration_.layout, step.segment(camera.first, camera.size), &calibration_.mean));
    window_.Renormalize(calibration_);
    window_.UpdateRates();
  }

  SmootherLandmark landmark_;
  Eigen::Vector3d gravity_W_ = GravityInWorld(kGravity);
  GnssWindow gnss_;
  WindowCalibration calibration_;
  Window window_;
  LinearPrior prior_;
  std::vector<WindowTrack*> tracks_;
  Eigen::MatrixXd covariance_;  ///< of calibration, newest clock and newest state
};

}  // namespace alidade::test
