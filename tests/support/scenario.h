#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/error_convention.h"
#include "core/estimator.h"
#include "core/random.h"
#include "eval/simulation/simulator.h"
#include "eval/trajectory/trajectory_interpolation.h"

namespace alidade::test {

/// A simulated figure-8 and what an estimator made of it.
struct ScenarioResult {
  Status status;
  int frames = 0;
  double rmse_position_m = 0;
  double rmse_orientation_rad = 0;
  double max_position_m = 0;
  double nees_pose = 0;  ///< mean over frames; 6 is ideal
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
  const TrajectoryPoint& truth = TruthAt(dataset, dataset.tracks.front().stamp_ns);
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

/// Feeds the sequence in time order and measures against the truth.
inline ScenarioResult RunScenario(const Dataset& dataset, const NavEstimate& initial, Estimator* estimator) {
  ScenarioResult result;
  result.status = estimator->Initialize(initial);
  size_t next = 0;
  for (const TrackFrame& frame : dataset.tracks) {
    if (!result.status.ok()) {
      break;
    }
    while (next < dataset.imu.size() && (next == 0 || dataset.imu[next - 1].stamp_ns < frame.stamp_ns)) {
      EXPECT_TRUE(estimator->AddImu(dataset.imu[next++]).ok());
    }
    result.status = estimator->AddFrame(frame);
    result.last = estimator->Latest();
    const NavState& truth = TruthAt(dataset, result.last.stamp_ns).nav;
    const Vector6d error = Local(ErrorConvention::kSo3xRn, result.last.nav, truth).head<6>();
    const Matrix6d covariance = result.last.covariance.topLeftCorner<6, 6>();
    result.nees_pose += error.dot(covariance.ldlt().solve(error));
    result.rmse_orientation_rad += error.head<3>().squaredNorm();
    result.rmse_position_m += error.tail<3>().squaredNorm();
    result.max_position_m = std::max(result.max_position_m, error.tail<3>().norm());
    ++result.frames;
  }
  const double frames = std::max(result.frames, 1);
  result.nees_pose /= frames;
  result.rmse_orientation_rad = std::sqrt(result.rmse_orientation_rad / frames);
  result.rmse_position_m = std::sqrt(result.rmse_position_m / frames);
  return result;
}

}  // namespace alidade::test
