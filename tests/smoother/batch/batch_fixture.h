#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "smoother/batch/batch_estimator.h"
#include "smoother/batch/batch_solver.h"
#include "smoother/sliding/smoother.h"
#include "tests/support/scenario.h"

namespace alidade::test {

struct BatchSequenceOptions {
  double duration_s = 4;
  double pixel_noise_px = 1;
  bool exact = false;  ///< no noise anywhere
  unsigned seed = 1;
  double outlier_rate = 0;
  SimOutlierKind outlier_kind = SimOutlierKind::kJump;
};

/// A few seconds of the figure-8, with fewer tracks than usual to keep the tests short.
inline Dataset MakeBatchDataset(const BatchSequenceOptions& options) {
  SimulatorConfig simulator;
  simulator.duration_s = options.duration_s;
  simulator.path_m = 1.3 * options.duration_s;
  simulator.max_features = 60;
  simulator.pixel_noise_px = options.exact ? 0 : options.pixel_noise_px;
  simulator.outlier_rate = options.outlier_rate;
  simulator.outlier_kind = options.outlier_kind;
  const ImuNoise noise = simulator.imu_noise;
  if (options.exact) {
    simulator.imu_noise = {0, 0, 0, 0};
    simulator.imu_rate_hz = 400;
  }
  Dataset dataset = SimulateOrDie(simulator, options.seed);
  dataset.rig.imu_noise = noise;
  return dataset;
}

/// A sliding window that never slides (up to 100 frames) and gates tracks as the batch does.
inline EstimatorConfig WholeWindowConfig() {
  EstimatorConfig config;
  config.backend = Backend::kSmoother;
  config.vision.robust_kernel = RobustKernel::kNone;
  config.vision.gate_probability = 1;
  config.vision.min_depth_m = 1e-3;
  config.vision.max_depth_m = 1e5;
  config.smoother.frames = FramePolicy::kEveryFrame;
  config.smoother.window = 100;
  config.smoother.max_iterations = 100;
  config.smoother.max_landmarks = 5000;
  config.smoother.keyframe_min_tracked = 0;
  return config;
}

/// The batch, started from a sliding-window smoother (the filter is not to be seen from here).
inline EstimatorConfig BatchTestConfig() {
  EstimatorConfig config;
  config.backend = Backend::kBatch;
  config.batch.initial = BatchInitial::kSmoother;
  config.smoother.window = 5;
  config.smoother.landmark = SmootherLandmark::kPoseOnly;
  return config;
}

struct BatchRun {
  std::unique_ptr<BatchEstimator> estimator;
  Result<std::vector<FinalizedFrame>> frames = Status::Input("not run");
};

inline BatchRun RunBatch(const Dataset& dataset, const EstimatorConfig& config, double perturb,
                         unsigned seed = 1, const std::atomic<bool>* stop = nullptr) {
  BatchRun run;
  run.estimator = std::make_unique<BatchEstimator>(config, dataset.rig, MakeSmoother(config, dataset.rig));
  const ScenarioResult forward =
      RunScenario(dataset, DrawInitialState(dataset, seed, perturb), run.estimator.get());
  EXPECT_TRUE(forward.status.ok()) << forward.status.message();
  run.frames = run.estimator->TakeFinalized(stop);
  return run;
}

/// (phi, dp, dv, dbg, dba) from the estimate to the truth.
inline Vector15d ErrorOf(const Dataset& dataset, const NavEstimate& estimate) {
  const TrajectoryPoint& truth = TruthAt(dataset, estimate.stamp_ns);
  Vector15d error;
  error << Local(ErrorConvention::kSo3xRn, estimate.nav, truth.nav), truth.bias.gyro - estimate.bias.gyro,
      truth.bias.accel - estimate.bias.accel;
  return error;
}

}  // namespace alidade::test
