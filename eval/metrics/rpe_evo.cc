#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/numbers.h"
#include "eval/metrics/tool_rpe.h"

namespace alidade {
namespace {

using IndexPair = std::pair<std::size_t, std::size_t>;
using Path = std::vector<NavState>;

double AngleBetween(const NavState& first, const NavState& second) {
  return so3::Log(first.R_WB.transpose() * second.R_WB).norm();
}

double StepLength(const Path& path, std::size_t i) {
  return i == 0 ? 0 : (path[i].p_WB - path[i - 1].p_WB).norm();
}

std::vector<IndexPair> PairsByFrames(const Path& path, std::size_t delta, bool all_pairs) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i + delta < path.size(); i += all_pairs ? 1 : delta) {
    pairs.emplace_back(i, i + delta);
  }
  return pairs;
}

std::vector<IndexPair> ConsecutiveByPath(const Path& path, double delta_m) {
  std::vector<IndexPair> pairs;
  std::optional<std::size_t> begin;
  double travelled = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    travelled += StepLength(path, i);
    if (travelled >= delta_m) {
      if (begin) {
        pairs.emplace_back(*begin, i);
      }
      begin = i;
      travelled = 0;
    }
  }
  return pairs;
}

std::vector<IndexPair> AllByPath(const Path& path, double delta_m, double tolerance_m) {
  std::vector<double> travelled(path.size(), 0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    travelled[i] = travelled[i - 1] + StepLength(path, i);
  }
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const auto miss = [&](std::size_t j) { return std::abs(travelled[j] - travelled[i] - delta_m); };
    const auto found = std::lower_bound(travelled.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                        travelled.end(), travelled[i] + delta_m);
    std::size_t end = std::min(static_cast<std::size_t>(found - travelled.begin()), path.size() - 1);
    while (end > i + 1 && miss(end - 1) <= miss(end)) {
      --end;
    }
    if (miss(end) <= tolerance_m) {
      pairs.emplace_back(i, end);
    }
  }
  return pairs;
}

std::vector<IndexPair> ConsecutiveByAngle(const Path& path, double delta_rad) {
  std::vector<IndexPair> pairs;
  std::size_t begin = 0;
  double turned = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    turned += AngleBetween(path[i - 1], path[i]);
    if (turned >= delta_rad) {
      pairs.emplace_back(begin, i);
      begin = i;
      turned = 0;
    }
  }
  return pairs;
}

std::vector<IndexPair> AllByAngle(const Path& path, double delta_rad, double tolerance_rad) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < path.size(); ++i) {
    for (std::size_t j = i + 1; j < path.size(); ++j) {
      const double angle = AngleBetween(path[i], path[j]);
      if (delta_rad - tolerance_rad <= angle && angle <= delta_rad + tolerance_rad) {
        pairs.emplace_back(i, j);
      }
    }
  }
  return pairs;
}

std::vector<IndexPair> PairsOver(const Path& path, double delta, const ToolRpeOptions& options) {
  if (options.unit == RpeUnit::kFrames) {
    return PairsByFrames(path, static_cast<std::size_t>(delta), options.all_pairs);
  }
  if (options.unit == RpeUnit::kMetres) {
    return options.all_pairs ? AllByPath(path, delta, delta * options.tolerance)
                             : ConsecutiveByPath(path, delta);
  }
  const double delta_rad = options.unit == RpeUnit::kDegrees ? delta / kDegreesPerRadian : delta;
  return options.all_pairs ? AllByAngle(path, delta_rad, delta_rad * options.tolerance)
                           : ConsecutiveByAngle(path, delta_rad);
}

/// Errors of every relation, one a pair.
struct EvoErrors {
  std::vector<double> translation, rotation, full, angle_deg, angle_rad, distance, distance_percent;

  void Add(const Pose& truth, const Pose& estimate) {
    const Pose error = truth.Inverse() * estimate;
    const double turn_squared = (error.rotation - Eigen::Matrix3d::Identity()).squaredNorm();
    translation.push_back(error.translation.norm());
    rotation.push_back(std::sqrt(turn_squared));
    full.push_back(std::sqrt(turn_squared + error.translation.squaredNorm()));
    angle_rad.push_back(so3::Log(error.rotation).norm());
    angle_deg.push_back(angle_rad.back() * kDegreesPerRadian);
    const double truth_distance = truth.translation.norm();
    distance.push_back(std::abs(truth_distance - estimate.translation.norm()));
    if (truth_distance != 0) {
      distance_percent.push_back(100 * distance.back() / truth_distance);
    }
  }

  [[nodiscard]] std::vector<RelationError> Relations() const {
    return {{"trans_part", "m", ComputeErrorStatistics(translation)},
            {"angle_deg", "deg", ComputeErrorStatistics(angle_deg)},
            {"angle_rad", "rad", ComputeErrorStatistics(angle_rad)},
            {"rot_part", "", ComputeErrorStatistics(rotation)},
            {"full", "", ComputeErrorStatistics(full)},
            {"point_distance", "m", ComputeErrorStatistics(distance)},
            {"point_distance_error_ratio", "%", ComputeErrorStatistics(distance_percent)}};
  }
};

Status CheckDelta(double delta, RpeUnit unit) {
  const std::string name = Format("a delta of %g ", delta) + std::string(ToString(unit));
  if (!(delta > 0 && std::isfinite(delta))) {
    return Status::Usage(name + ": expected above 0");
  }
  if (unit == RpeUnit::kFrames && delta != std::floor(delta)) {
    return Status::Usage(name + ": expected a whole number of frames");
  }
  const double limit = unit == RpeUnit::kRadians ? std::numbers::pi : 180;
  if ((unit == RpeUnit::kDegrees || unit == RpeUnit::kRadians) && delta > limit) {
    return Status::Usage(name + ": expected at most " + Format("%.6g", limit));
  }
  return Status::Ok();
}

}  // namespace

Result<std::vector<ToolRpeResult>> ComputeEvoRpe(const std::vector<StatePair>& aligned_pairs,
                                                 const ToolRpeOptions& options) {
  Path path;
  for (const StatePair& pair : aligned_pairs) {
    path.push_back(options.pairs_from_truth ? pair.truth.nav : pair.estimate.nav);
  }
  std::vector<ToolRpeResult> results;
  for (const double delta : options.deltas.empty() ? std::vector<double>{1} : options.deltas) {
    ALIDADE_RETURN_IF_ERROR(CheckDelta(delta, options.unit));
    const std::vector<IndexPair> pairs = PairsOver(path, delta, options);
    EvoErrors errors;
    for (const auto& [i, j] : pairs) {
      errors.Add(aligned_pairs[i].truth.nav.T_WB().Inverse() * aligned_pairs[j].truth.nav.T_WB(),
                 aligned_pairs[i].estimate.nav.T_WB().Inverse() * aligned_pairs[j].estimate.nav.T_WB());
    }
    results.push_back({delta, pairs.size(), errors.Relations()});
  }
  return results;
}

}  // namespace alidade
