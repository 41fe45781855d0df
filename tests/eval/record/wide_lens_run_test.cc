#include <gtest/gtest.h>

#include <cmath>

#include "eval/metrics/association.h"
#include "eval/metrics/nees.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"

// Estimators on lenses whose rays point behind the camera.

namespace alidade {
namespace {

/// 15 s of the figure-8 with a lens of 220 degrees across the diagonal.
SimulatorConfig WideScene() {
  SimulatorConfig config;
  config.duration_s = 15;
  config.path_m = 20;
  config.distortion = DistortionModel::kDoubleSphere;
  config.distortion_coefficients << -0.18, 0.59, 0, 0;
  config.focal_px = 199.5;
  config.max_features = 80;
  return config;
}

EstimatorConfig Estimator(Backend backend) {
  EstimatorConfig config;
  config.backend = backend;
  config.init.method = InitMethod::kTruth;
  config.filter.update = UpdateTiming::kDelayedAll;
  config.filter.track_memory = TrackMemoryPolicy::kCarry;
  config.filter.clone_policy = ClonePolicy::kOldest;
  return config;
}

RunResult RunOn(const EstimatorConfig& config, const Dataset& dataset, std::uint64_t seed) {
  RunOptions options;
  options.truth = &*dataset.truth;
  options.true_rig = dataset.true_rig ? &*dataset.true_rig : nullptr;
  options.seed = seed;
  return RunEstimator(config, {dataset.rig, dataset.imu, dataset.tracks}, options);
}

NeesResult NeesOf(const RunResult& result, const Dataset& dataset) {
  const Result<std::vector<StatePair>> pairs = Associate(*dataset.truth, TrajectoryOf(result), {});
  EXPECT_TRUE(pairs.ok()) << pairs.message();
  return ComputeNees(*pairs);
}

double MeanUsed(const RunResult& result) {
  double used = 0;
  for (const RunRecord& record : result.records) {
    used += record.statistics.features_used;
  }
  return used / static_cast<double>(result.records.size());
}

struct Case {
  const char* name;
  EstimatorConfig config;
};

std::vector<Case> Cases() {
  EstimatorConfig slam_filter = Estimator(Backend::kFilter);
  slam_filter.filter.landmark = FilterLandmark::kMsckf;
  slam_filter.filter.track_memory = TrackMemoryPolicy::kNone;
  slam_filter.filter.slam_features = 20;
  EstimatorConfig smoother = Estimator(Backend::kSmoother);
  smoother.smoother.landmark = SmootherLandmark::kPoseOnly;
  smoother.smoother.slam_features = 20;
  EstimatorConfig inverse_depth = Estimator(Backend::kSmoother);
  inverse_depth.smoother.landmark = SmootherLandmark::kInverseDepth;
  return {{"filter", Estimator(Backend::kFilter)},
          {"filter with SLAM features", slam_filter},
          {"smoother", smoother},
          {"smoother with inverse depths", inverse_depth}};
}

// GIVEN a lens of 220 degrees WHEN each estimator runs with the plane the lens chooses THEN its covariance
// covers the error, and it uses more of the tracks than the plane z = 1 can carry.
TEST(WideLensRun, EveryEstimatorIsConsistentOnTangentPlanes) {
  const Result<Dataset> dataset = Simulate(WideScene(), 905);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  ASSERT_EQ(dataset->rig.camera.plane(), ObservationPlane::kTangent);
  for (const Case& c : Cases()) {
    SCOPED_TRACE(c.name);
    const RunResult result = RunOn(c.config, *dataset, 905);
    ASSERT_TRUE(result.status.ok()) << result.status.message();
    EXPECT_TRUE(result.restarts.empty());
    const NeesResult nees = NeesOf(result, *dataset);
    EXPECT_LT(nees.mean_pose, 14) << "6 on average over runs";
    EXPECT_GT(nees.coverage_3sigma, 0.95);
    EstimatorConfig plane = c.config;
    plane.vision.observation_plane = PlaneChoice::kNormalized;
    const RunResult on_plane = RunOn(plane, *dataset, 905);
    EXPECT_GT(MeanUsed(result), MeanUsed(on_plane));
  }
}

// GIVEN the tracks that lie beside and behind the camera alone, which no plane z = 1 carries, THEN both back
// ends run on them, and one of them starts on its own.
TEST(WideLensRun, WhatLiesBesideAndBehindIsEnough) {
  SimulatorConfig scene = WideScene();
  scene.max_features = 1500;
  scene.wobble_rad = 0.2;
  Result<Dataset> dataset = Simulate(scene, 906);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  const CameraModel& camera = dataset->rig.camera;
  for (TrackFrame& frame : dataset->tracks) {
    std::erase_if(frame.observations, [&](const TrackObservation& seen) {
      Eigen::Vector3d ray;
      return !camera.Bearing(seen.pixel, &ray) || ray.z() > 0;
    });
  }
  for (const Backend backend : {Backend::kFilter, Backend::kSmoother}) {
    EstimatorConfig config = Estimator(backend);
    config.smoother.landmark = SmootherLandmark::kPoseOnly;
    config.init.method = backend == Backend::kFilter ? InitMethod::kDynamic : InitMethod::kTruth;
    const RunResult result = RunOn(config, *dataset, 906);
    ASSERT_TRUE(result.status.ok()) << result.status.message() << result.init_report;
    if (backend == Backend::kFilter) {  // which uses a track once, when it ends
      EXPECT_GT(MeanUsed(result) * static_cast<double>(result.records.size()), 30);
    } else {  // the filter's start has a yaw and a place of its own
      EXPECT_GT(MeanUsed(result), 5);
      EXPECT_GT(NeesOf(result, *dataset).coverage_3sigma, 0.9);
    }
  }
}

}  // namespace
}  // namespace alidade
