#include "eval/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/numbers.h"

namespace alidade {
namespace {

/// A sub-trajectory may miss the wanted length by this share of it: sparse pairs then count for nothing
/// rather than for another distance.
constexpr double kRpeLengthTolerance = 0.1;

double RootMeanSquare(double sum_of_squares, std::size_t count) {
  return count == 0 ? kNan : std::sqrt(sum_of_squares / static_cast<double>(count));
}

/// Truth path travelled up to each pair [m]; the first is 0.
std::vector<double> CumulativePath(const std::vector<StatePair>& pairs) {
  std::vector<double> path(pairs.size(), 0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    path[i] = path[i - 1] + (pairs[i].truth.nav.p_WB - pairs[i - 1].truth.nav.p_WB).norm();
  }
  return path;
}

/// T_first,second: the second pose in the frame of the first.
Pose Relative(const NavState& first, const NavState& second) {
  return first.T_WB().Inverse() * second.T_WB();
}

RpeResult RpeOver(const std::vector<StatePair>& pairs, const std::vector<double>& path, double distance_m) {
  RpeResult result;
  result.distance_m = distance_m;
  double pos_squares = 0, ori_squares = 0;
  std::size_t end = 0;
  const bool usable = distance_m > 0 && std::isfinite(distance_m);
  for (std::size_t start = 0; start < pairs.size() && usable; ++start) {
    const double target = path[start] + distance_m;
    end = std::max(end, start);
    while (end + 1 < pairs.size() && path[end] < target) {
      ++end;
    }
    if (end == start) {
      break;  // the last pair starts nothing
    }
    const double last_step = path[end] - path[end - 1];
    const double overshoot = path[end] - target;
    if (overshoot < -0.5 * last_step) {
      break;  // the path ends before the target, and so it does for all later starts
    }
    const std::size_t nearest = overshoot > 0.5 * last_step ? end - 1 : end;
    if (std::abs(path[nearest] - target) > kRpeLengthTolerance * distance_m) {
      continue;
    }
    const Pose truth = Relative(pairs[start].truth.nav, pairs[nearest].truth.nav);
    const Pose estimate = Relative(pairs[start].estimate.nav, pairs[nearest].estimate.nav);
    const double pos_error = (truth.translation - estimate.translation).norm();
    result.pos_errors_m.push_back(pos_error);
    pos_squares += pos_error * pos_error;
    ori_squares += so3::Log(estimate.rotation.transpose() * truth.rotation).squaredNorm();
  }
  result.count = static_cast<int>(result.pos_errors_m.size());
  result.pos_rmse_m = RootMeanSquare(pos_squares, result.pos_errors_m.size());
  result.ori_rmse_deg = RootMeanSquare(ori_squares, result.pos_errors_m.size()) * kDegreesPerRadian;
  return result;
}

}  // namespace

AteResult ComputeAte(const std::vector<StatePair>& aligned_pairs) {
  AteResult result;
  double pos_squares = 0, ori_squares = 0, pos_squares_max = 0;
  for (const StatePair& pair : aligned_pairs) {
    const double squared = (pair.truth.nav.p_WB - pair.estimate.nav.p_WB).squaredNorm();
    pos_squares += squared;
    pos_squares_max = std::max(pos_squares_max, squared);
    ori_squares += so3::Log(pair.estimate.nav.R_WB.transpose() * pair.truth.nav.R_WB).squaredNorm();
  }
  result.pos_m = RootMeanSquare(pos_squares, aligned_pairs.size());
  result.ori_deg = RootMeanSquare(ori_squares, aligned_pairs.size()) * kDegreesPerRadian;
  result.pos_max_m = aligned_pairs.empty() ? kNan : std::sqrt(pos_squares_max);
  return result;
}

std::vector<RpeResult> ComputeRpe(const std::vector<StatePair>& pairs,
                                  const std::vector<double>& distances_m) {
  const std::vector<double> path = CumulativePath(pairs);
  std::vector<RpeResult> results;
  results.reserve(distances_m.size());
  for (const double distance_m : distances_m) {
    results.push_back(RpeOver(pairs, path, distance_m));
  }
  return results;
}

double PathLength(const std::vector<StatePair>& pairs) {
  return pairs.empty() ? 0 : CumulativePath(pairs).back();
}

}  // namespace alidade
