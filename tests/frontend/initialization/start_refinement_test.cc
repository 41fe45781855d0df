// The chi-squares by which the refinement accepts a solution.

#include "frontend/initialization/start_refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <iostream>

#include "core/imu_buffer.h"
#include "eval/simulation/simulator.h"
#include "frontend/initialization/dynamic_initializer.h"
#include "frontend/initialization/gyro_bias_fit.h"
#include "frontend/initialization/linear_start.h"

namespace alidade {
namespace {

using testing::HasSubstr;

constexpr double kWindowS = 2.0;

Dataset MovingSequence() {
  SimulatorConfig simulator;
  simulator.duration_s = 30;
  simulator.path_m = 45;
  return *Simulate(simulator, 611);
}

std::deque<TrackFrame> FramesFrom(const Dataset& dataset, size_t first) {
  std::deque<TrackFrame> frames;
  for (size_t i = first; i < dataset.frames.size() && SecondsBetween(dataset.frames[first].stamp_ns,
                                                                     dataset.frames[i].stamp_ns) <= kWindowS;
       ++i) {
    frames.push_back(dataset.frames[i]);
  }
  return frames;
}

ImuBuffer AllSamples(const Dataset& dataset) {
  ImuBuffer imu(1.0);
  for (const ImuSample& sample : dataset.imu) {
    EXPECT_TRUE(imu.Add(sample).ok());
  }
  return imu;
}

TEST(StartRefinement, GIVEN_the_sheets_noise_THEN_both_chi_squares_are_about_one_in_the_mean) {
  const Dataset dataset = MovingSequence();
  ImuBuffer imu = AllSamples(dataset);
  const EstimatorConfig config;
  RefinementSettings settings;
  settings.T_BC = dataset.rig.T_BC;
  settings.gravity_mps2 = config.imu.gravity_mps2;
  double inertial = 0;
  double reprojection = 0;
  int windows = 0;
  for (size_t first = 0; first + 22 < dataset.frames.size(); first += 12) {
    SCOPED_TRACE(first);
    DynamicWindow window;
    ASSERT_TRUE(
        BuildDynamicWindow(config, dataset.rig.camera, FramesFrom(dataset, first), kWindowS, &imu, &window)
            .ok());
    std::vector<Preintegration> steps = PreintegrateWindow(window, ImuBias(), dataset.rig.imu_noise);
    const GyroBiasFit gyro = FitGyroBias(window, steps, dataset.rig);
    const ImuBias bias{gyro.gyro_bias, Eigen::Vector3d::Zero()};
    steps = PreintegrateWindow(window, bias, dataset.rig.imu_noise);
    const Result<LinearStart> linear =
        SolveLinearStart(window, steps, bias, gyro.inlier, dataset.rig.T_BC, config.imu.gravity_mps2);
    ASSERT_TRUE(linear.ok()) << linear.message();
    const Result<RefinedStart> refined =
        RefineStart(window, gyro.inlier, steps, linear->states, linear->bias, settings);
    if (refined.ok()) {
      inertial += refined->inertial_chi2;
      reprojection += refined->reprojection_chi2;
      ++windows;
    }
  }
  inertial /= windows;
  reprojection /= windows;
  std::cout << "  " << windows << " windows: inertial " << inertial << ", reprojection " << reprojection
            << "\n";
  ASSERT_GE(windows, 15);
  // Below one: the process noise also covers motion between samples (core/imu_vibration.h).
  EXPECT_GT(inertial, 0.5);
  EXPECT_LT(inertial, 1.2);
  EXPECT_NEAR(reprojection, 1, 0.1);
}

TEST(StartRefinement, GIVEN_specific_force_that_vision_contradicts_THEN_the_start_is_refused) {
  Dataset dataset = MovingSequence();
  for (ImuSample& sample : dataset.imu) {
    const double t = SecondsBetween(dataset.imu.front().stamp_ns, sample.stamp_ns);
    sample.accel.x() += 2 * std::sin(2 * M_PI * 0.8 * t);
  }
  ImuBuffer imu = AllSamples(dataset);
  const EstimatorConfig config;
  for (const size_t first : {20U, 60U, 100U, 140U, 200U}) {
    SCOPED_TRACE(first);
    Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
    const Result<DynamicSolution> solution = InitializeDynamic(
        config, dataset.rig, FramesFrom(dataset, first), DynamicLimits{0.5, kWindowS}, &imu, &accel_bias);
    ASSERT_FALSE(solution.ok());
    EXPECT_THAT(solution.message(), HasSubstr("inertial chi-square"));
  }
}

}  // namespace
}  // namespace alidade
