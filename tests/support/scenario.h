#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/error_convention.h"
#include "core/estimator/estimator.h"
#include "core/random.h"
#include "eval/record/run_options.h"
#include "eval/record/runner.h"
#include "eval/simulation/simulator.h"
#include "eval/simulation/simulator_config.h"
#include "eval/trajectory/trajectory_interpolation.h"

namespace alidade::test {

/// A simulated figure-8 and what an estimator made of it.
struct ScenarioResult {
  Status status;
  int frames = 0;
  double rmse_position_m = 0;
  double rmse_orientation_rad = 0;
  double max_position_m = 0;
  double nees_pose = 0;           ///< mean over frames; 6 is ideal
  double scale = 0;               ///< of the estimated velocities to the true ones, in the least squares
  double max_pixel_noise_px = 0;  ///< that a frame's observations were given
  NavEstimate last;
};

inline Dataset SimulateOrDie(const SimulatorConfig& config, unsigned seed) {
  Result<Dataset> dataset = Simulate(config, seed);
  EXPECT_TRUE(dataset.ok()) << dataset.message();
  return dataset.ok() ? *dataset : Dataset();
}

/// The true state at a stamp that the truth holds exactly (camera stamps of the simulator do).
inline const TrajectoryPoint& TruthAt(const Dataset& dataset, TimeNs stamp_ns) {
  const auto& points = dataset.truth->points;
  const std::size_t found = FirstAtOrAfter(points, stamp_ns);
  EXPECT_TRUE(found < points.size() && points[found].stamp_ns == stamp_ns);
  return points[found];
}

/// The truth at the first frame, displaced by a draw from the prior it comes with.
inline NavEstimate DrawInitialState(const Dataset& dataset, unsigned seed, double scale = 1) {
  const TrajectoryPoint& truth = TruthAt(dataset, dataset.frames.front().stamp_ns);
  Vector15d deviation;
  deviation << Eigen::Vector3d::Constant(2e-3), Eigen::Vector3d::Constant(1e-3),
      Eigen::Vector3d::Constant(1e-2), Eigen::Vector3d::Constant(2e-3), Eigen::Vector3d::Constant(2e-2);
  RandomStream random(seed, "initial state");
  Vector15d error;
  for (int i = 0; i < 15; ++i) {
    error[i] = scale * deviation[i] * random.Normal();
  }
  NavEstimate initial;
  initial.stamp_ns = truth.stamp_ns;
  initial.nav = Retract(ErrorConvention::kSo3xRn, truth.nav, Vector9d(error.head<9>()));
  initial.bias = {truth.bias.gyro + error.segment<3>(9), truth.bias.accel + error.tail<3>()};
  initial.covariance = deviation.cwiseAbs2().asDiagonal();
  return initial;
}

/// The forward pass of an estimator: what it revises at the end is left to the test.
class ForwardPass : public Estimator {
 public:
  explicit ForwardPass(Estimator* estimator) : estimator_(*estimator) {}

  Status Initialize(const NavEstimate& initial) override { return estimator_.Initialize(initial); }
  Status AddImu(const ImuSample& sample) override { return estimator_.AddImu(sample); }
  Status AddFrame(const TrackFrame& frame) override { return estimator_.AddFrame(frame); }
  NavEstimate Latest() const override { return estimator_.Latest(); }
  bool initialized() const override { return estimator_.initialized(); }
  const FrameStatistics& last_statistics() const override { return estimator_.last_statistics(); }
  std::optional<CalibrationEstimate> LatestCalibration() const override {
    return estimator_.LatestCalibration();
  }

 private:
  Estimator& estimator_;
};

/// Runs the estimator over the sequence from `initial` on and measures against the truth.
inline ScenarioResult RunScenario(const Dataset& dataset, const NavEstimate& initial, Estimator* estimator) {
  EstimatorConfig config;
  config.init.method = InitMethod::kTruth;
  config.recovery.enabled = false;
  RunOptions options;
  options.start_state = [&](TimeNs) { return Result<NavEstimate>(initial); };
  ForwardPass forward(estimator);
  const RunResult run = RunEstimator(config, {dataset.rig, dataset.imu, dataset.frames}, options, &forward);
  EXPECT_EQ(run.imu_rejected, 0);
  ScenarioResult result;
  double speeds = 0;
  result.status = run.status.ok() && run.frames_skipped > 0 ? Status::Input(run.skip_report) : run.status;
  for (const RunRecord& record : run.records) {
    result.last = record.estimate;
    result.max_pixel_noise_px = std::max(result.max_pixel_noise_px, record.statistics.pixel_noise_px);
    const NavState& truth = TruthAt(dataset, result.last.stamp_ns).nav;
    const Vector6d error = Local(ErrorConvention::kSo3xRn, result.last.nav, truth).head<6>();
    const Matrix6d covariance = result.last.covariance.topLeftCorner<6, 6>();
    result.nees_pose += error.dot(covariance.ldlt().solve(error));
    result.rmse_orientation_rad += error.head<3>().squaredNorm();
    result.rmse_position_m += error.tail<3>().squaredNorm();
    result.max_position_m = std::max(result.max_position_m, error.tail<3>().norm());
    result.scale += result.last.nav.v_WB.dot(truth.v_WB);
    speeds += truth.v_WB.squaredNorm();
    ++result.frames;
  }
  const double frames = std::max(result.frames, 1);
  result.scale /= speeds;
  result.nees_pose /= frames;
  result.rmse_orientation_rad = std::sqrt(result.rmse_orientation_rad / frames);
  result.rmse_position_m = std::sqrt(result.rmse_position_m / frames);
  return result;
}

}  // namespace alidade::test
