#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/yaw_shift.h"
#include "tests/frontend/initialization/initializer_scenario.h"
#include "tests/support/preset_run.h"

namespace alidade {
namespace {

// Where single seeds are named, they are those of the smoother's worst runs with this kernel.
const char* const kHuber = "vision.robust_kernel=huber";

/// Of the pose.
double Nees(const std::string& preset, const SimulatorConfig& sim, unsigned seed,
            std::vector<std::string> overrides = {}) {
  const Dataset dataset = test::SimulateOrDie(sim, seed);
  overrides.push_back("vision.pixel_noise_px=" + std::to_string(sim.pixel_noise_px));
  return test::RunPreset(preset, overrides, dataset, seed, 5).nees_pose;
}

SimulatorConfig Motion(SimTrajectory trajectory, const Eigen::Vector3d& extent_m, double path_m,
                       double duration_s) {
  SimulatorConfig sim;
  sim.trajectory = trajectory;
  sim.duration_s = duration_s;
  sim.length_m = extent_m.x();
  sim.width_m = extent_m.y();
  sim.height_m = extent_m.z();
  sim.path_m = path_m;
  return sim;
}

/// Slow among distant landmarks, with a weak IMU: the scale is known to a quarter only when the first window
/// is full.
SimulatorConfig SlowMotion(SimTrajectory trajectory, const Eigen::Vector3d& extent_m, double path_m,
                           double duration_s) {
  SimulatorConfig sim = Motion(trajectory, extent_m, path_m, duration_s);
  sim.camera_rate_hz = 20;
  sim.pixel_noise_px = 0.7;
  sim.imu_noise = {9e-4, 3e-3, 9e-5, 6e-4};
  sim.landmark_min_distance_m = 4;
  sim.landmark_max_distance_m = 32;
  sim.max_range_m = 51.2;
  sim.landmark_count = 1335;
  return sim;
}

// GIVEN a walk of 0.1 m/s whose velocity is known to 0.05 m/s at its start, so that the scale is uncertain by
// half, WHEN the window changes its shape with every correction THEN the filter does not take that for
// knowledge of the scale. A few runs say little here, so that the mean of many is bounded as well.
TEST(UncertainScale, CorrectionsDoNotRevealIt) {
  SimulatorConfig sim = Motion(SimTrajectory::kFigureEight, {3, 1.5, 0.15}, 2.5, 25);
  sim.landmark_min_distance_m = 1;
  sim.landmark_max_distance_m = 6;
  sim.pixel_noise_px = 0.7;
  for (const unsigned seed : {526U, 527U, 528U, 530U}) {
    EXPECT_LT(Nees("alidade_filter", sim, seed), 20) << "seed " << seed;
  }
  constexpr int kRuns = 24;
  double mean = 0;
  for (unsigned seed = 596; seed < 596 + kRuns; ++seed) {
    mean += Nees("alidade_filter", sim, seed) / kRuns;
  }
  EXPECT_LT(mean, 15);
}

// GIVEN a hover of 0.03 m/s whose velocity is known to 0.05 m/s at its start WHEN the first tracks show that
// the camera has moved far less than predicted THEN the filter linearises them until that is found, and has
// no use for them where no window fits them.
TEST(UncertainScale, IsFoundThoughTheStartIsAlmostAtRest) {
  const SimulatorConfig sim = Motion(SimTrajectory::kHover, {0.6, 0.4, 0.2}, 0.8, 25);
  for (const unsigned seed : {68002U, 68003U, 68030U, 68060U}) {
    EXPECT_LT(Nees("alidade_filter", sim, seed), 30) << "seed " << seed;
  }
}

// GIVEN the same hover WHEN the smoother's first window could as well have stood still THEN it does not end
// there, certain of it.
TEST(UncertainScale, OfTheSmoothersStartDoesNotVanish) {
  const SimulatorConfig sim = Motion(SimTrajectory::kHover, {0.6, 0.4, 0.2}, 0.8, 12);
  for (const unsigned seed : {71009U, 71011U}) {
    EXPECT_LT(Nees("alidade_smoother", sim, seed), 20) << "seed " << seed;  // without: 348 and 970
  }
}

// GIVEN a rig that drifts by a centimetre a second WHEN noise looks like parallax THEN the smoother with the
// gate at the typical depth does not take the tracks whose noise confirms the estimated motion, nor many
// assumed depths, for knowledge.
TEST(UncertainScale, IsNotFoundInNoise) {
  const SimulatorConfig sim = Motion(SimTrajectory::kHover, {0.6, 0.4, 0.2}, 0.2, 15);
  constexpr unsigned kRuns = 6;
  const auto mean = [&](unsigned first, const std::string& gate) {
    double sum = 0;
    for (unsigned seed = first; seed < first + kRuns; ++seed) {
      sum += Nees("alidade_smoother", sim, seed, {"smoother.parallax_gate=" + gate});
    }
    return sum / kRuns;
  };
  EXPECT_LT(mean(71006, "typical"),
            20);  // of these, three have 58 to 693 where each track's own depth decides
  const double typical = mean(71021, "typical");
  EXPECT_LT(typical, 15);
  EXPECT_GT(mean(71021, "own"), 2 * typical);
}

/// Of the frames of a run, the largest share of tracks whose depth was none.
class DegenerateShare final : public test::ForwardPass {
 public:
  using ForwardPass::ForwardPass;
  Status AddFrame(const TrackFrame& frame) override {
    const Status status = ForwardPass::AddFrame(frame);
    const FrameStatistics& statistics = last_statistics();
    if (statistics.tracks_in > 0) {
      largest = std::max(largest, static_cast<double>(statistics.features_degenerate) / statistics.tracks_in);
    }
    return status;
  }

  double largest = 0;
};

// GIVEN a rig that pauses for six seconds, with too much wobble for rest, WHEN noise puts the depth of half
// of the tracks behind the camera THEN they wait: tracks that contradict the state would end the run.
TEST(UncertainScale, InAPauseTracksWait) {
  SimulatorConfig sim = Motion(SimTrajectory::kEllipse, {2.1, 1.8, 0.25}, 6.1, 16);
  sim.pause_s = 6;
  sim.pause_period_s = 20;
  sim.camera_rate_hz = 20;
  sim.imu_rate_hz = 200;
  sim.imu_noise = {9e-5, 3e-4, 9e-6, 6e-5};
  sim.landmark_min_distance_m = 4;
  sim.landmark_max_distance_m = 16;
  sim.max_range_m = 25;
  sim.landmark_count = 1200;
  const Dataset dataset = test::SimulateOrDie(sim, 75001);
  const Result<EstimatorConfig> config =
      LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/alidade_smoother.yaml", {});
  ASSERT_TRUE(config.ok()) << config.message();
  const std::unique_ptr<Estimator> smoother = MakeEstimator(*config, dataset.rig);
  DegenerateShare share(smoother.get());
  const auto run = test::RunScenario(dataset, test::DrawInitialState(dataset, 75001), &share);
  EXPECT_TRUE(run.status.ok()) << run.status.message();
  EXPECT_LT(share.largest, 0.1);  // 0.19 where their own depth decides
  EXPECT_LT(run.nees_pose, 15);
}

// GIVEN a motion of 0.14 m/s that moves tracks of scenery at 20 m by less than a pixel in half a second WHEN
// it is taken for rest THEN the velocity is as uncertain as the scenery leaves it.
TEST(UncertainScale, IsNotZeroAmongFarScenery) {
  SimulatorConfig sim = Motion(SimTrajectory::kLine, {33, 24, 1.3}, 5.6, 40);
  sim.camera_rate_hz = 10;
  sim.imu_rate_hz = 200;
  sim.max_features = 80;
  sim.landmark_count = 984;
  sim.landmark_min_distance_m = 11;
  sim.landmark_max_distance_m = 33;
  sim.max_range_m = 50;
  constexpr int kRuns = 12;
  double mean = 0;
  for (unsigned seed = 74001; seed < 74001 + kRuns; ++seed) {
    mean += Nees("alidade_filter", sim, seed) / kRuns;
  }
  EXPECT_LT(mean, 40);  // 198 where the velocity is zero to two centimetres a second
  for (const unsigned seed : {74002U, 74008U}) {  // 875 and 1315 likewise
    EXPECT_LT(Nees("alidade_smoother", sim, seed, {kHuber}), 300) << "seed " << seed;
  }
}

// GIVEN a sideways ellipse of 0.13 m/s, seen so that its first window hardly tells its scale WHEN all tracks
// are linearised again and again THEN the window does not creep along the scale, which costs next to nothing.
TEST(UncertainScale, IsNotFollowedWhereTheCostIsFlat) {
  SimulatorConfig sim = Motion(SimTrajectory::kEllipse, {3, 2, 0.2}, 5.3, 40);
  sim.camera_view = SimCameraView::kSideways;
  sim.landmark_min_distance_m = 1;
  sim.landmark_max_distance_m = 8;
  sim.max_range_m = 12;
  for (const unsigned seed : {66007U, 66021U}) {
    EXPECT_LT(Nees("alidade_filter", sim, seed), 20) << "seed " << seed;
  }
}

// GIVEN such a motion WHEN few tracks correct the window in a frame THEN the filter's step along the scale
// does not shrink it from frame to frame.
TEST(UncertainScale, IsNoReasonToStepAlongIt) {
  const SimulatorConfig ellipse = SlowMotion(SimTrajectory::kEllipse, {7.45, 4.35, 0.86}, 12, 30);
  for (const unsigned seed : {7301U, 7303U, 995106U}) {
    EXPECT_LT(Nees("alidade_filter", ellipse, seed), 20) << "ellipse, seed " << seed;
  }
  const SimulatorConfig spiral = SlowMotion(SimTrajectory::kSpiral, {6, 4, 0.8}, 16, 60);
  for (const unsigned seed : {995104U, 995107U, 995108U}) {
    EXPECT_LT(Nees("alidade_filter", spiral, seed), 20) << "spiral, seed " << seed;
  }
}

// GIVEN such a motion WHEN the shape of the window changes after frames have left THEN the smoother's prior
// does not prefer a smaller window.
TEST(UncertainScale, ThePriorOfTheSmootherDoesNotShrinkTheWindow) {
  const SimulatorConfig sim = SlowMotion(SimTrajectory::kSpiral, {6, 4, 0.16}, 3.2, 12);
  for (const unsigned seed : {995101U, 7302U, 7304U}) {
    EXPECT_LT(Nees("alidade_smoother", sim, seed), 14) << "seed " << seed;
  }
}

// GIVEN an accelerometer so poor that vision determines the window's shape better, and the IMU its scale WHEN
// the scale's direction is carried from correction to correction THEN the IMU's noise is not taken for
// motion, which would make the scale grow.
TEST(UncertainScale, TheNoiseOfAPoorAccelerometerDoesNotEnlargeIt) {
  SimulatorConfig sim;
  sim.duration_s = 60;
  sim.path_m = 78;
  sim.imu_noise.accel_noise_density_mps2_sqrthz = 0.1;
  double nees = 0;
  double scale = 0;
  for (const unsigned seed : {61U, 62U, 63U, 64U}) {
    const Dataset dataset = test::SimulateOrDie(sim, seed);
    const test::ScenarioResult result = test::RunPreset("alidade_filter", {}, dataset, seed, 5);
    nees += result.nees_pose / 4;
    scale += result.scale / 4;
  }
  EXPECT_LT(nees, 14);
  EXPECT_NEAR(scale, 1, 0.06);
}

/// What the initialiser finds, at the true yaw and position; the sequence then begins there.
NavEstimate OwnStart(const EstimatorConfig& config, Dataset* dataset) {
  const test::StartOutcome start = test::StartAt(config, *dataset, dataset->frames.front().stamp_ns, 10);
  EXPECT_TRUE(start.ok) << start.message;
  const TimeNs stamp_ns = start.estimate.stamp_ns;
  std::erase_if(dataset->frames, [&](const TrackFrame& frame) { return frame.stamp_ns < stamp_ns; });
  const NavState& truth = test::TruthAt(*dataset, stamp_ns).nav;
  YawShift shift{std::atan2(truth.R_WB(1, 0), truth.R_WB(0, 0))};
  shift.p_NW = truth.p_WB;
  return shift * start.estimate;
}

// GIVEN an own start on an ellipse at 15 m/s, which knows the scale to a tenth because its force could be a
// bias of the accelerometer, WHEN corrections change the scale by as much THEN no step of second order in
// them moves it by several deviations.
TEST(UncertainScale, IsNotMovedByLargeStepsOnAConstantTurn) {
  SimulatorConfig sim = Motion(SimTrajectory::kEllipse, {300, 150, 4}, 600, 40);
  sim.camera_view = SimCameraView::kSideways;
  sim.camera_rate_hz = 20;
  sim.imu_rate_hz = 200;
  sim.landmark_count = 6000;
  sim.landmark_min_distance_m = 10;
  sim.landmark_max_distance_m = 60;
  sim.max_range_m = 100;
  constexpr unsigned kRuns = 8;
  double mean = 0;
  for (unsigned seed = 35001; seed < 35001 + kRuns; ++seed) {
    Dataset dataset = test::SimulateOrDie(sim, seed);
    const Result<EstimatorConfig> config =
        LoadEstimatorConfig(ALIDADE_SOURCE_DIR "/configs/estimators/alidade_filter.yaml", {});
    ASSERT_TRUE(config.ok()) << config.message();
    const NavEstimate initial = OwnStart(*config, &dataset);
    const std::unique_ptr<Estimator> estimator = MakeEstimator(*config, dataset.rig);
    const double nees = test::RunScenario(dataset, initial, estimator.get()).nees_pose;
    std::cout << "  seed " << seed << ": " << nees << "\n";
    mean += nees / kRuns;
  }
  EXPECT_LT(mean, 16);  // 14; without the limit of the step 22
}

}  // namespace
}  // namespace alidade
