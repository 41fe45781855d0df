#include <gtest/gtest.h>

#include "eval/metrics/nees.h"
#include "eval/record/recorder.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/trajectory_interpolation.h"
#include "eval/trajectory/trajectory_point.h"
#include "tests/eval/record/estimator_runs.h"

// Multipath that the stated noise lacks, with both back ends.

namespace alidade {
namespace {

class GnssMultipathRunTest : public testing::TestWithParam<Backend> {
 protected:
  /// Mean NEES of the position from 5 s on.
  static double PositionNees(double multipath_m, bool lasting_errors, unsigned seed) {
    SimulatorConfig scene;
    scene.start_time_s = 1700000000;
    scene.duration_s = 25;
    scene.length_m = 60;
    scene.width_m = 30;
    scene.height_m = 3;
    scene.path_m = 100;
    scene.landmark_count = 2000;
    scene.landmark_max_distance_m = 20;
    scene.max_features = 60;
    scene.gnss.rate_hz = 10;
    scene.gnss.multipath_m = multipath_m;
    const Result<Dataset> dataset = Simulate(scene, seed);
    EXPECT_TRUE(dataset.ok()) << dataset.message();
    EstimatorConfig config = test::CarryingEstimator(GetParam());
    config.filter.window = 12;
    config.smoother.landmark = SmootherLandmark::kPoseOnly;
    config.gnss.enabled = true;
    config.gnss.lasting_errors = lasting_errors;
    config.gnss.corrections.model_std_scale = 0;
    config.gnss.corrections.pseudorange_std_m = 0.5;
    RunOptions options;
    options.truth = &*dataset->truth;
    options.seed = seed;
    const RunResult result =
        RunEstimator(config, {dataset->rig, dataset->imu, dataset->frames, {}, dataset->gnss}, options);
    EXPECT_TRUE(result.status.ok()) << result.status.message();
    std::vector<StatePair> pairs;
    for (const RunRecord& record : result.records) {
      const Result<TrajectoryPoint> truth = InterpolateTruth(*dataset->truth, record.estimate.stamp_ns);
      if (truth.ok() &&
          SecondsBetween(result.records.front().estimate.stamp_ns, record.estimate.stamp_ns) > 5) {
        pairs.push_back({*truth, PointOf(record.estimate)});
      }
    }
    EXPECT_GT(pairs.size(), 100U);
    return ComputeNees(pairs).mean_position;
  }
};

TEST_P(GnssMultipathRunTest, TheCovarianceCoversErrorsThatLast) {
  double nees = 0, as_white = 0;
  for (const unsigned seed : {971, 972, 973}) {
    nees += PositionNees(1.5, true, seed) / 3;
    as_white += PositionNees(1.5, false, seed) / 3;
  }
  // 3 is ideal. Three runs hold few independent errors.
  EXPECT_LT(nees, 15);
  EXPECT_GT(as_white, 100) << "else nothing is shown";
}

TEST_P(GnssMultipathRunTest, WhiteErrorsStayInBand) {
  const double nees = PositionNees(0, true, 971);
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 9);
}

INSTANTIATE_TEST_SUITE_P(BothBackEnds, GnssMultipathRunTest,
                         testing::Values(Backend::kFilter, Backend::kSmoother),
                         [](const auto& of) { return of.param == Backend::kFilter ? "filter" : "smoother"; });

}  // namespace
}  // namespace alidade
