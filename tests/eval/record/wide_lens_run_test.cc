#include <gtest/gtest.h>

#include <cmath>

#include "eval/metrics/association.h"
#include "eval/metrics/nees.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "tests/eval/record/estimator_runs.h"

// Estimators on lenses whose rays point behind the camera.

namespace alidade {
namespace {

using test::CarryingEstimator;
using test::EveryLandmark;
using test::NamedEstimator;
using test::RunOn;

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

// GIVEN a lens of 220 degrees WHEN each estimator runs with the plane the lens chooses THEN its covariance
// covers the error, and it uses more of the tracks than the plane z = 1 can carry.
TEST(WideLensRun, EveryEstimatorIsConsistentOnTangentPlanes) {
  const Result<Dataset> dataset = Simulate(WideScene(), 905);
  ASSERT_TRUE(dataset.ok()) << dataset.message();
  ASSERT_EQ(dataset->rig.camera.plane(), ObservationPlane::kTangent);
  for (const NamedEstimator& c : EveryLandmark()) {
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
  for (TrackFrame& frame : dataset->frames) {
    std::erase_if(frame.observations, [&](const TrackObservation& seen) {
      Eigen::Vector3d ray;
      return !camera.Bearing(seen.pixel, &ray) || ray.z() > 0;
    });
  }
  for (const Backend backend : {Backend::kFilter, Backend::kSmoother}) {
    EstimatorConfig config = CarryingEstimator(backend);
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
