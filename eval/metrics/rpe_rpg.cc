#include <algorithm>
#include <cmath>

#include "core/numbers.h"
#include "eval/metrics/tool_rpe.h"

namespace alidade {
namespace {

/// Share of the length by which a sub-trajectory may miss it.
constexpr double kLengthTolerance = 0.2;

std::vector<double> TravelledByTruth(const std::vector<StatePair>& pairs) {
  std::vector<double> travelled(pairs.size(), 0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    travelled[i] = travelled[i - 1] + (pairs[i].truth.nav.p_WB - pairs[i - 1].truth.nav.p_WB).norm();
  }
  return travelled;
}

/// The end of every beginning that has one, in order.
std::vector<std::size_t> FindEnds(const std::vector<double>& travelled, double length_m) {
  std::vector<std::size_t> ends;
  for (std::size_t begin = 0; begin < travelled.size(); ++begin) {
    const double target = travelled[begin] + length_m;
    const auto miss = [&](std::size_t i) { return std::abs(travelled[i] - target); };
    const auto found =
        std::lower_bound(travelled.begin() + static_cast<std::ptrdiff_t>(begin), travelled.end(), target);
    std::size_t end = std::min(static_cast<std::size_t>(found - travelled.begin()), travelled.size() - 1);
    while (end > begin && miss(end - 1) <= miss(end)) {
      --end;
    }
    if (miss(end) < kLengthTolerance * length_m) {
      ends.push_back(end);
    }
  }
  return ends;
}

/// Errors of every relation, one a sub-trajectory.
struct RpgErrors {
  std::vector<double> translation, percent, rotation, yaw, gravity, rotation_per_metre;

  /// `end_rotation`: R_WB of the estimate at the end, which turns the error into axes of its world.
  void Add(const Pose& truth, const Pose& estimate, const Eigen::Matrix3d& end_rotation, double length_m) {
    const Pose error = truth.Inverse() * estimate;
    const Eigen::Matrix3d turn = end_rotation * error.rotation * end_rotation.transpose();
    translation.push_back(error.translation.norm());
    percent.push_back(100 * translation.back() / length_m);
    rotation.push_back(so3::Log(error.rotation).norm() * kDegreesPerRadian);
    rotation_per_metre.push_back(rotation.back() / length_m);
    const double roll = std::atan2(turn(2, 1), turn(2, 2));
    const double pitch = std::atan2(-turn(2, 0), std::hypot(turn(0, 0), turn(1, 0)));
    yaw.push_back(std::abs(std::atan2(turn(1, 0), turn(0, 0))) * kDegreesPerRadian);
    gravity.push_back(std::hypot(pitch, roll) * kDegreesPerRadian);
  }

  [[nodiscard]] std::vector<RelationError> Relations() const {
    return {{"trans", "m", ComputeErrorStatistics(translation)},
            {"trans_perc", "%", ComputeErrorStatistics(percent)},
            {"rot", "deg", ComputeErrorStatistics(rotation)},
            {"yaw", "deg", ComputeErrorStatistics(yaw)},
            {"gravity", "deg", ComputeErrorStatistics(gravity)},
            {"rot_deg_per_m", "deg/m", ComputeErrorStatistics(rotation_per_metre)}};
  }
};

}  // namespace

std::vector<ToolRpeResult> ComputeRpgRelativeErrors(const std::vector<StatePair>& unaligned_pairs,
                                                    double scale, const std::vector<double>& lengths_m) {
  const std::vector<double> travelled = TravelledByTruth(unaligned_pairs);
  std::vector<ToolRpeResult> results;
  for (const double length_m : lengths_m) {
    std::vector<std::size_t> ends = FindEnds(travelled, length_m);
    if (ends.size() < 2) {
      ends.clear();
    }
    RpgErrors errors;
    for (std::size_t k = 0; k < ends.size(); ++k) {
      const StatePair& first = unaligned_pairs[k];
      const StatePair& last = unaligned_pairs[ends[k]];
      Pose estimate = first.estimate.nav.T_WB().Inverse() * last.estimate.nav.T_WB();
      estimate.translation *= scale;
      errors.Add(first.truth.nav.T_WB().Inverse() * last.truth.nav.T_WB(), estimate, last.estimate.nav.R_WB,
                 length_m);
    }
    results.push_back({length_m, ends.size(), errors.Relations()});
  }
  return results;
}

std::vector<double> DefaultRpgLengths(const Trajectory& truth) {
  double path_m = 0;
  for (std::size_t i = 1; i < truth.points.size(); ++i) {
    path_m += (truth.points[i].nav.p_WB - truth.points[i - 1].nav.p_WB).norm();
  }
  std::vector<double> lengths_m;
  for (const double share : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    lengths_m.push_back(std::trunc(share * path_m * 100) / 100);
  }
  return lengths_m;
}

}  // namespace alidade
