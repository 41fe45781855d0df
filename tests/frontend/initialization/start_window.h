#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "core/imu_buffer.h"
#include "eval/simulation/simulator.h"
#include "frontend/initialization/gyro_bias_fit.h"
#include "frontend/initialization/linear_start.h"
#include "frontend/initialization/refinement_settings.h"

namespace alidade::test {

inline constexpr double kStartWindowS = 2.0;

inline Dataset MovingSequence() {
  SimulatorConfig simulator;
  simulator.duration_s = 30;
  simulator.path_m = 45;
  return *Simulate(simulator, 611);
}

inline std::deque<TrackFrame> FramesFrom(const Dataset& dataset, size_t first) {
  std::deque<TrackFrame> frames;
  for (size_t i = first;
       i < dataset.frames.size() &&
       SecondsBetween(dataset.frames[first].stamp_ns, dataset.frames[i].stamp_ns) <= kStartWindowS;
       ++i) {
    frames.push_back(dataset.frames[i]);
  }
  return frames;
}

inline ImuBuffer AllSamples(const Dataset& dataset) {
  ImuBuffer imu(1.0);
  for (const ImuSample& sample : dataset.imu) {
    EXPECT_TRUE(imu.Add(sample).ok());
  }
  return imu;
}

/// What the refinement of a start begins with.
struct StartWindow {
  DynamicWindow window;
  std::vector<Preintegration> steps;
  std::vector<bool> inlier;
  std::vector<NavState> states;
  ImuBias bias;
  RefinementSettings settings;
};

/// From frame `first` of the sequence on.
inline void MakeStartWindow(const EstimatorConfig& config, const Dataset& dataset, size_t first,
                            StartWindow* start) {
  ImuBuffer imu = AllSamples(dataset);
  const Status built = BuildDynamicWindow(config, dataset.rig.camera, FramesFrom(dataset, first),
                                          kStartWindowS, &imu, &start->window);
  ASSERT_TRUE(built.ok()) << built.message();
  start->steps = PreintegrateWindow(start->window, ImuBias(), dataset.rig.imu_noise);
  const GyroBiasFit gyro = FitGyroBias(start->window, start->steps, dataset.rig);
  const ImuBias bias{gyro.gyro_bias, Eigen::Vector3d::Zero()};
  start->inlier = gyro.inlier;
  start->steps = PreintegrateWindow(start->window, bias, dataset.rig.imu_noise);
  const Result<LinearStart> linear = SolveLinearStart(start->window, start->steps, bias, gyro.inlier,
                                                      dataset.rig.T_BC, config.imu.gravity_mps2);
  ASSERT_TRUE(linear.ok()) << linear.message();
  start->states = linear->states;
  start->bias = linear->bias;
  start->settings.T_BC = dataset.rig.T_BC;
  start->settings.gravity_mps2 = config.imu.gravity_mps2;
}

}  // namespace alidade::test
