#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "filter/filter.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/sliding/smoother.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_system.h"
#include "tests/integration/one_window.h"
#include "tests/support/estimate_difference.h"
#include "tests/support/jacobian_checker.h"

// One window without marginalisation is one least-squares problem. The filter linearises it once and the
// smoother until it converges, so that they differ by the curvature over the errors alone: where the errors
// vanish against the assumed deviations, both must end with the same mean and the same covariance.

namespace alidade {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::kFrames;
using test::kGravity;
using test::kTracks;
using test::MakeWindow;
using test::MeanDifference;
using test::OneWindow;
using test::RelativeDifference;

/// Room for the whole window, no kernel; the gate passes all that the model explains.
EstimatorConfig MakeConfig(ErrorConvention convention) {
  EstimatorConfig config;
  config.imu.gravity_mps2 = kGravity;
  config.vision.robust_kernel = RobustKernel::kNone;
  config.vision.max_relative_depth_deviation = 1;
  config.vision.gate_probability = 1 - 1e-9;
  config.vision.rest_updates = false;
  config.filter.error = convention;
  config.filter.window = kFrames + 2;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.smoother.error = convention;
  config.smoother.window = kFrames + 2;
  config.smoother.frames = FramePolicy::kEveryFrame;
  return config;
}

struct FilterCase {
  std::string name;
  FilterLandmark landmark = FilterLandmark::kMsckf;
  int slam_features = 0;
  TrackMemoryPolicy memory = TrackMemoryPolicy::kNone;
};

/// How the filter uses a view: with its track at the end, or at once by what it keeps of the landmark.
const std::array<FilterCase, 4>& FilterCases() {
  static const std::array<FilterCase, 4> cases = {
      {{"pose-only", FilterLandmark::kPoseOnlyMulti},
       {"eliminated landmarks", FilterLandmark::kMsckf},
       {"SLAM features", FilterLandmark::kMsckf, kTracks},
       {"track memory", FilterLandmark::kPoseOnlyMulti, 0, TrackMemoryPolicy::kCarry}}};
  return cases;
}

std::unique_ptr<Estimator> MakeFilter(const FilterCase& of, EstimatorConfig config,
                                      const RigCalibration& rig) {
  config.filter.landmark = of.landmark;
  config.filter.slam_features = of.slam_features;
  config.filter.slam_min_track = 4;
  config.filter.slam_max_depth_deviation = 1;
  config.filter.track_memory = of.memory;
  config.filter.memory_depth_deviation = 1;
  return alidade::MakeFilter(config, rig);
}

std::unique_ptr<Estimator> MakeSmoother(SmootherLandmark landmark, EstimatorConfig config,
                                        const RigCalibration& rig) {
  config.smoother.landmark = landmark;
  return alidade::MakeSmoother(config, rig);
}

NavEstimate Estimate(const OneWindow& window, Estimator* estimator) {
  EXPECT_TRUE(estimator->Initialize(window.start).ok());
  size_t next = 0;
  for (const TrackFrame& frame : window.frames) {
    while (next < window.samples.size() && window.samples[next].stamp_ns <= frame.stamp_ns) {
      EXPECT_TRUE(estimator->AddImu(window.samples[next++]).ok());
    }
    const Status status = estimator->AddFrame(frame);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(estimator->last_statistics().features_gated, 0);
    EXPECT_EQ(estimator->last_statistics().features_degenerate, 0);
  }
  return estimator->Latest();
}

constexpr SmootherLandmark kSmootherLandmarks[] = {SmootherLandmark::kPoseOnly,
                                                   SmootherLandmark::kInverseDepth};

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
    }
    EXPECT_TRUE(MakeInitialPrior(config.smoother.error, window_.frame(0), data.start.covariance, &prior_));
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
    MatrixXd rows(0, columns.size());
    VectorXd residual(0);
    for (const std::unique_ptr<WindowTerm>& term : MakeTerms()) {
      LinearTerm linear;
      EXPECT_TRUE(term->Linearize(&linear).ok());
      linear.MakeRows();
      const Index first = rows.rows();
      rows.conservativeResize(first + linear.residual.size(), Eigen::NoChange);
      rows.bottomRows(linear.residual.size()).setZero();
      for (const TermPart& part : linear.parts) {
        rows.block(first, columns.Find(part.of).first, linear.residual.size(), part.width) =
            linear.jacobian.middleCols(part.first, part.width);
      }
      residual.conservativeResize(rows.rows());
      residual.tail(linear.residual.size()) = linear.residual;
    }
    const Eigen::HouseholderQR<MatrixXd> qr(rows);
    Move(columns, qr.solve(-residual));
    const Matrix15d root =
        qr.matrixQR().topRows(columns.size()).bottomRightCorner<15, 15>().triangularView<Eigen::Upper>();
    const Matrix15d inverse = root.triangularView<Eigen::Upper>().solve(Matrix15d::Identity());
    covariance_ = inverse * inverse.transpose();
  }

  void Move(const ColumnMap& columns, const VectorXd& step) {
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

class LinearLimitTest : public testing::TestWithParam<ErrorConvention> {
 protected:
  [[nodiscard]] static std::string Name(const FilterCase& filter, SmootherLandmark landmark) {
    return filter.name + (landmark == SmootherLandmark::kPoseOnly ? " to pose-only" : " to inverse depth");
  }
};

// GIVEN equal starts, IMU samples and tracks whose errors are small WHEN the filter has read one window and
// the smoother's terms of it are solved, THEN the newest states agree to a millionth: the means relative to
// the correction by the measurements, the covariances relative to themselves; whichever way either of them
// treats landmarks.
TEST_P(LinearLimitTest, FilterAgreesWithTheSolutionOfTheSmoothersTerms) {
  const OneWindow window = MakeWindow(1e-6);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate solved = TermSolution(window, config, landmark).Newest();
    const double correction = MeanDifference(window.carried, solved);
    EXPECT_GT(correction, 1e-6) << "vision has something to correct";
    EXPECT_GT(RelativeDifference(window.carried.covariance, solved.covariance), 1) << "and is informative";
    for (const FilterCase& filter : FilterCases()) {
      SCOPED_TRACE(Name(filter, landmark));
      const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
      EXPECT_LT(MeanDifference(filtered, solved), 1e-6 * correction);
      EXPECT_LT(RelativeDifference(filtered.covariance, solved.covariance), 1e-6);
    }
  }
}

// GIVEN the same, THEN the smoother itself ends with that covariance, and with that mean to a millionth of
// its deviation and as far as its solver converges.
TEST_P(LinearLimitTest, FilterAgreesWithTheSmoother) {
  const OneWindow window = MakeWindow(1e-6);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const std::unique_ptr<Estimator> smoother = MakeSmoother(landmark, config, window.rig);
    const NavEstimate smoothed = Estimate(window, smoother.get());
    EXPECT_EQ(smoother->last_statistics().features_used, kTracks);
    for (const FilterCase& filter : FilterCases()) {
      SCOPED_TRACE(Name(filter, landmark));
      const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
      EXPECT_LT(MeanDifference(filtered, smoothed), 1e-6);
      EXPECT_LT(MeanDifference(filtered, smoothed), 0.01 * MeanDifference(window.carried, smoothed));
      EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-6);
    }
  }
}

// GIVEN data without any error, THEN both linearise at the same point: the covariances agree to rounding.
TEST_P(LinearLimitTest, WithoutErrorsTheCovariancesAreTheSame) {
  const OneWindow window = MakeWindow(0);
  const EstimatorConfig config = MakeConfig(GetParam());
  for (const SmootherLandmark landmark : kSmootherLandmarks) {
    const NavEstimate smoothed = Estimate(window, MakeSmoother(landmark, config, window.rig).get());
    for (const FilterCase& filter : FilterCases()) {
      const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
      EXPECT_LT(MeanDifference(filtered, smoothed), 1e-9) << Name(filter, landmark);
      EXPECT_LT(RelativeDifference(filtered.covariance, smoothed.covariance), 1e-9) << Name(filter, landmark);
    }
  }
}

// GIVEN errors ten times as small, THEN the difference of the covariances is: what is left is the point of
// linearisation, to first order.
TEST_P(LinearLimitTest, TheDifferenceVanishesWithTheErrors) {
  const auto difference = [&](const FilterCase& filter, double scale) {
    const OneWindow window = MakeWindow(scale);
    const EstimatorConfig config = MakeConfig(GetParam());
    const NavEstimate smoothed =
        Estimate(window, MakeSmoother(SmootherLandmark::kPoseOnly, config, window.rig).get());
    const NavEstimate filtered = Estimate(window, MakeFilter(filter, config, window.rig).get());
    return RelativeDifference(filtered.covariance, smoothed.covariance);
  };
  for (const FilterCase& filter : FilterCases()) {
    EXPECT_NEAR(difference(filter, 1e-3) / difference(filter, 1e-2), 0.1, 0.02) << filter.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, LinearLimitTest, testing::ValuesIn(test::kAllConventions),
                         [](const auto& item) { return std::string(ToString(item.param)); });

}  // namespace
}  // namespace alidade
