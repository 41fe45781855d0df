#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "eval/metrics/state_pair.h"

namespace alidade::test {

/// A vector of independent normal draws.
inline Eigen::Vector3d DrawVector(std::mt19937_64& random, double sigma) {
  std::normal_distribution<double> normal(0, sigma);
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

/// A rotation far from the identity, in any direction.
inline Eigen::Matrix3d DrawRotation(std::mt19937_64& random) {
  return so3::Exp(DrawVector(random, 1.0));
}

/// Full 3-D motion: `rows` points 0.1 s apart from stamp 1e9 ns on a bent, twisted path.
inline Trajectory MakeTrajectory(int rows, TimeNs first_ns = 1'000'000'000, TimeNs step_ns = 100'000'000) {
  Trajectory trajectory;
  trajectory.has_velocity = true;
  for (int i = 0; i < rows; ++i) {
    const double t = 0.1 * i;
    TrajectoryPoint point;
    point.stamp_ns = first_ns + i * step_ns;
    point.nav.p_WB = {5 * std::sin(0.3 * t), 3 * std::sin(0.6 * t), 0.5 * std::cos(0.7 * t)};
    point.nav.v_WB = {1.5 * std::cos(0.3 * t), 1.8 * std::cos(0.6 * t), -0.35 * std::sin(0.7 * t)};
    point.nav.R_WB = so3::Exp({0.2 * std::sin(t), 0.3 * std::cos(0.8 * t), 0.3 * t});
    trajectory.points.push_back(point);
  }
  return trajectory;
}

/// Truth and an estimate equal to it, row by row.
inline std::vector<StatePair> PerfectPairs(int rows) {
  std::vector<StatePair> pairs;
  for (const TrajectoryPoint& point : MakeTrajectory(rows).points) {
    pairs.push_back({point, point});
  }
  return pairs;
}

}  // namespace alidade::test
