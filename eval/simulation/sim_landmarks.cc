#include "eval/simulation/sim_landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "core/random.h"

namespace alidade {
namespace {

constexpr int kMaxTriesPerLandmark = 100;
constexpr double kMaxThrown = 1e7;

/// Throws landmarks between two distances around the path.
class Shell {
 public:
  Shell(const SimulatorConfig& config, const std::vector<Eigen::Vector3d>& path)
      : path_(path), min_m_(config.landmark_min_distance_m), max_m_(config.landmark_max_distance_m) {}

  Eigen::Vector3d Throw(RandomStream* stream) const {
    constexpr double kMaxSinElevation = 0.35;
    const Eigen::Vector3d& origin = path_[static_cast<std::size_t>(stream->Below(path_.size()))];
    const double azimuth = stream->Uniform(0, 2 * std::numbers::pi);
    const double sine = stream->Uniform(-kMaxSinElevation, kMaxSinElevation);
    const double cosine = std::sqrt(1 - sine * sine);
    const double distance_m = stream->Uniform(min_m_, max_m_);
    return origin +
           distance_m * Eigen::Vector3d(cosine * std::cos(azimuth), cosine * std::sin(azimuth), sine);
  }

 private:
  const std::vector<Eigen::Vector3d>& path_;
  double min_m_;
  double max_m_;
};

/// Throws landmarks at the six walls of a box around the path.
class Room {
 public:
  Room(const SimulatorConfig& config, const std::vector<Eigen::Vector3d>& path)
      : low_(path.front()), high_(path.front()), depth_m_(config.room_depth_m) {
    for (const Eigen::Vector3d& point : path) {
      low_ = low_.cwiseMin(point);
      high_ = high_.cwiseMax(point);
    }
    low_ -= config.room_margin_m;
    high_ += config.room_margin_m;
  }

  Eigen::Vector3d Throw(RandomStream* stream) const {
    const Eigen::Vector3d size = high_ - low_;
    const std::array<double, 3> area = {size.y() * size.z(), size.z() * size.x(), size.x() * size.y()};
    // The axis across the wall, each as likely as its walls are large.
    double choice = stream->Uniform(0, area[0] + area[1] + area[2]);
    int axis = 0;
    while (axis < 2 && choice >= area[static_cast<std::size_t>(axis)]) {
      choice -= area[static_cast<std::size_t>(axis)];
      ++axis;
    }
    Eigen::Vector3d p_W;
    for (int i = 0; i < 3; ++i) {
      p_W[i] = stream->Uniform(low_[i], high_[i]);
    }
    const double depth_m = stream->Uniform(0, depth_m_);
    p_W[axis] = stream->Chance(0.5) ? low_[axis] + depth_m : high_[axis] - depth_m;
    return p_W;
  }

 private:
  Eigen::Vector3d low_;
  Eigen::Vector3d high_;
  double depth_m_;
};

/// Positions of the body by the cell of a grid, so that only near ones are searched.
class PathGrid {
 public:
  PathGrid(const std::vector<Eigen::Vector3d>& path, double cell_m) : cell_m_(cell_m) {
    for (const Eigen::Vector3d& point : path) {
      cells_[CellOf(point)].push_back(point);
    }
  }

  /// Distance to the path; infinite when that is more than a cell.
  [[nodiscard]] double DistanceTo(const Eigen::Vector3d& p_W) const {
    double squared = std::numeric_limits<double>::infinity();
    const Cell centre = CellOf(p_W);
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          const auto found = cells_.find({centre[0] + x, centre[1] + y, centre[2] + z});
          for (std::size_t i = 0; found != cells_.end() && i < found->second.size(); ++i) {
            squared = std::min(squared, (found->second[i] - p_W).squaredNorm());
          }
        }
      }
    }
    return std::sqrt(squared);
  }

 private:
  using Cell = std::array<int, 3>;

  [[nodiscard]] Cell CellOf(const Eigen::Vector3d& point) const {
    Cell cell;
    for (int i = 0; i < 3; ++i) {
      cell[static_cast<std::size_t>(i)] = static_cast<int>(std::floor(point[i] / cell_m_));
    }
    return cell;
  }

  double cell_m_;
  std::map<Cell, std::vector<Eigen::Vector3d>> cells_;
};

/// Landmarks evenly in the box around the path; kept are those between the two distances from it. Their
/// number, not their density, is left to chance.
Result<std::vector<Eigen::Vector3d>> FillVolume(const SimulatorConfig& config,
                                                const std::vector<Eigen::Vector3d>& path,
                                                std::uint64_t seed) {
  Eigen::Vector3d low = path.front(), high = path.front();
  for (const Eigen::Vector3d& point : path) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  low.array() -= config.landmark_max_distance_m;
  high.array() += config.landmark_max_distance_m;
  const double wanted = config.landmark_density_per_m3 * (high - low).prod();
  if (!(wanted <= kMaxThrown)) {
    return Status::Config("landmark_density_per_m3: " + std::to_string(config.landmark_density_per_m3) +
                          " makes more than 1e7 landmarks in the box around this path; expected fewer");
  }
  const PathGrid grid(path, config.landmark_max_distance_m);
  RandomStream stream(seed, "world.landmarks");
  std::vector<Eigen::Vector3d> landmarks;
  for (std::int64_t i = 0; i < std::llround(wanted); ++i) {
    Eigen::Vector3d p_W;
    for (int axis = 0; axis < 3; ++axis) {
      p_W[axis] = stream.Uniform(low[axis], high[axis]);
    }
    const double distance_m = grid.DistanceTo(p_W);
    if (distance_m >= config.landmark_min_distance_m && distance_m <= config.landmark_max_distance_m) {
      landmarks.push_back(p_W);
    }
  }
  if (landmarks.empty()) {
    return Status::Config("landmark_density_per_m3: " + std::to_string(config.landmark_density_per_m3) +
                          " gives no landmark around this path; expected more");
  }
  return landmarks;
}

/// Throws until `count` landmarks keep their distance from the path.
template <typename Layout>
Result<std::vector<Eigen::Vector3d>> ThrowAll(const Layout& layout, const SimulatorConfig& config,
                                              const std::vector<Eigen::Vector3d>& path, std::uint64_t seed,
                                              const char* key) {
  const double min2 = config.landmark_min_distance_m * config.landmark_min_distance_m;
  const auto count = static_cast<std::size_t>(config.landmark_count);
  RandomStream stream(seed, "world.landmarks");
  std::vector<Eigen::Vector3d> landmarks;
  landmarks.reserve(count);
  for (std::size_t tries = 0; landmarks.size() < count; ++tries) {
    if (tries >= count * kMaxTriesPerLandmark) {
      return Status::Config(std::string(key) +
                            ": no room for landmarks beyond landmark_min_distance_m of the path");
    }
    const Eigen::Vector3d p_W = layout.Throw(&stream);
    if (std::none_of(path.begin(), path.end(),
                     [&](const Eigen::Vector3d& point) { return (point - p_W).squaredNorm() < min2; })) {
      landmarks.push_back(p_W);
    }
  }
  return landmarks;
}

}  // namespace

std::vector<Eigen::Vector3d> SamplePath(const ContinuousTrajectory& trajectory, double spacing_m) {
  constexpr double kStepSeconds = 0.01;
  std::vector<Eigen::Vector3d> points = {trajectory.At(0).nav.p_WB};
  const int steps = static_cast<int>(trajectory.DurationSeconds() / kStepSeconds);
  for (int i = 1; i <= steps; ++i) {
    const Eigen::Vector3d p_WB = trajectory.At(i * kStepSeconds).nav.p_WB;
    if ((p_WB - points.back()).norm() >= spacing_m) {
      points.push_back(p_WB);
    }
  }
  return points;
}

Result<std::vector<Eigen::Vector3d>> MakeLandmarks(const SimulatorConfig& config,
                                                   const ContinuousTrajectory& trajectory,
                                                   std::uint64_t seed) {
  const std::vector<Eigen::Vector3d> path = SamplePath(trajectory, 0.1 * config.landmark_min_distance_m);
  if (config.landmark_layout == SimLandmarkLayout::kRoom) {
    return ThrowAll(Room(config, path), config, path, seed, "room_margin_m");
  }
  if (config.landmark_layout == SimLandmarkLayout::kVolume) {
    return FillVolume(config, path, seed);
  }
  return ThrowAll(Shell(config, path), config, path, seed, "landmark_max_distance_m");
}

}  // namespace alidade
