#pragma once

#include <cmath>
#include <string>

#include "eval/trajectory/trajectory.h"

namespace alidade::test {

struct TrajectoryPair {
  Trajectory truth, estimate;
};

inline Eigen::Matrix3d About(const Eigen::Vector3d& axis, double angle) {
  return so3::Exp(angle * axis);
}

inline NavState FormulaTruth(double t) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  NavState nav;
  nav.p_WB = {5 * std::sin(0.35 * t) + 0.15 * t, 4 * std::sin(0.7 * t + 0.3), 1.5 + 0.5 * std::sin(0.5 * t)};
  nav.R_WB = About(z, 0.4 * t + 0.2 * std::sin(0.9 * t)) * About(y, 0.15 * std::sin(0.6 * t)) *
             About(x, 0.1 * std::cos(0.8 * t));
  return nav;
}

/// The truth turned, scaled and shifted, with errors of some centimetres and a degree.
inline NavState FormulaEstimate(double t) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const NavState truth = FormulaTruth(t);
  const Eigen::Matrix3d turn = About(z, 0.7) * About(x, 0.01);
  NavState nav;
  nav.p_WB = turn * (1.02 * truth.p_WB) + Eigen::Vector3d(3, -2 + 0.004 * t, 0.5) +
             0.05 * Eigen::Vector3d(std::sin(3.1 * t + 1), std::sin(2.7 * t + 2), std::cos(2.3 * t));
  nav.R_WB = turn * truth.R_WB * About(x, 0.010 * std::sin(1.7 * t)) * About(y, 0.012 * std::cos(1.3 * t)) *
             About(z, 0.020 * std::sin(0.4 * t));
  return nav;
}

/// Stamps of `rate_hz` from `begin_s` to `end_s`, each off by a fixed pseudo-random number of microseconds up
/// to `jitter_us`, without those in [gap_begin_s, gap_end_s).
struct FormulaStamps {
  int rate_hz, begin_s, end_s, jitter_us;
  double gap_begin_s, gap_end_s;
};

inline Trajectory FormulaTrajectory(const FormulaStamps& stamps, NavState (*state)(double)) {
  constexpr TimeNs kStart = 1403636579763555584;  // doubles of seconds have steps of 0.24 us there
  const TimeNs step = 1'000'000'000 / stamps.rate_hz;
  Trajectory trajectory;
  for (int i = 0; i < (stamps.end_s - stamps.begin_s) * stamps.rate_hz; ++i) {
    const TimeNs jitter = ((i * 7919 + 13) % (2 * stamps.jitter_us + 1) - stamps.jitter_us) * TimeNs{1000};
    const TimeNs stamp = stamps.begin_s * TimeNs{1'000'000'000} + i * step + jitter;
    const double t = static_cast<double>(stamp) * 1e-9;
    if (t < stamps.gap_begin_s || t >= stamps.gap_end_s) {
      TrajectoryPoint point;
      point.stamp_ns = kStart + stamp;
      point.nav = state(t);
      trajectory.points.push_back(point);
    }
  }
  return trajectory;
}

/// "camera": truth at 100 Hz with a gap, estimate at 20 Hz with another. "crowded": truth at 10 Hz, estimate
/// at 24 Hz over a part of it, so that several estimates are nearest to one truth row. "dense": the estimate
/// has more rows than the truth.
inline TrajectoryPair FormulaPair(const std::string& name) {
  if (name == "camera") {
    return {FormulaTrajectory({100, 0, 60, 2000, 20, 22.5}, FormulaTruth),
            FormulaTrajectory({20, 3, 55, 4000, 35, 36}, FormulaEstimate)};
  }
  if (name == "crowded") {
    return {FormulaTrajectory({10, 0, 60, 20000, -2, -1}, FormulaTruth),
            FormulaTrajectory({24, 10, 30, 9000, 17, 18}, FormulaEstimate)};
  }
  return {FormulaTrajectory({10, 0, 60, 20000, 40, 43}, FormulaTruth),
          FormulaTrajectory({37, 2, 50, 5000, -2, -1}, FormulaEstimate)};
}

}  // namespace alidade::test
