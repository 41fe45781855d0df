#include "eval/render/render_hall.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/random.h"
#include "eval/render/render_texture.h"
#include "eval/simulation/sim_landmarks.h"

namespace alidade {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMaxTries = 20;
constexpr double kMaxObjects = 2e4;

/// Throws what stands in the hall. Coordinates are those of the hall.
class Builder {
 public:
  Builder(const SimulatorConfig& config, const std::vector<Vector3d>& path_W, std::uint64_t seed)
      : config_(config), stream_(seed, "render.hall") {
    Vector3d low = path_W.front(), high = path_W.front();
    for (const Vector3d& point : path_W) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    hall_.origin_W = 0.5 * (low + high);
    half_ = 0.5 * (high - low) + config.room_margin_m;
    for (const Vector3d& point : path_W) {
      path_.push_back(point - hall_.origin_W);
    }
  }

  /// Boxes and columns that the densities ask for.
  [[nodiscard]] double ObjectCount() const {
    const RenderConfig& render = config_.render;
    return FloorArea() * (render.box_density_per_m2 + render.column_density_per_m2) +
           (FloorArea() + WallArea()) * render.panel_density_per_m2 +
           FloorArea() * render.moving_density_per_m2;
  }

  Hall Build() {
    const RenderConfig& render = config_.render;
    hall_.room = MakeBox(-half_, half_, TextureKind::kBricks);
    hall_.room.faces[4].texture = static_cast<int>(TextureKind::kTiles);
    hall_.room.faces[5].texture = static_cast<int>(TextureKind::kPanels);
    ThrowAll(render.column_density_per_m2 * FloorArea(), [this] { return ThrowColumn(); });
    ThrowAll(render.box_density_per_m2 * FloorArea(), [this] { return ThrowFloorBox(); });
    ThrowAll(render.panel_density_per_m2 * WallArea(), [this] { return ThrowPanel(); });
    ThrowAll(render.panel_density_per_m2 * FloorArea(), [this] { return ThrowBeam(); });
    return hall_;
  }

 private:
  [[nodiscard]] double FloorArea() const { return 4 * half_.x() * half_.y(); }
  [[nodiscard]] double WallArea() const { return 8 * half_.z() * (half_.x() + half_.y()); }

  template <typename Throw>
  void ThrowAll(double count, const Throw& try_once) {
    for (int i = 0; i < static_cast<int>(std::lround(count)); ++i) {
      for (int tries = 0; tries < kMaxTries && !try_once(); ++tries) {
      }
    }
  }

  double Uniform(double low, double high) { return stream_.Uniform(low, high); }

  Surface MakeSurface(TextureKind kind, double light) {
    return {static_cast<int>(kind),
            {static_cast<float>(Uniform(0, 100)), static_cast<float>(Uniform(0, 100))},
            static_cast<float>(light * Uniform(0.85, 1.15))};
  }

  /// Light comes from above and a little from one side.
  HallBox MakeBox(const Vector3d& low, const Vector3d& high, TextureKind kind) {
    constexpr std::array<double, 6> kLight = {0.85, 1.0, 0.9, 0.8, 0.7, 1.1};
    HallBox box;
    box.low = low.cast<float>();
    box.high = high.cast<float>();
    for (std::size_t face = 0; face < box.faces.size(); ++face) {
      box.faces[face] = MakeSurface(kind, kLight[face]);
    }
    return box;
  }

  bool AddBox(const Vector3d& low, const Vector3d& high, TextureKind kind) {
    for (const Vector3d& point : path_) {
      const Vector3d nearest = point.cwiseMax(low).cwiseMin(high);
      if ((point - nearest).norm() < config_.landmark_min_distance_m) {
        return false;
      }
    }
    hall_.boxes.push_back(MakeBox(low, high, kind));
    return true;
  }

  bool ThrowColumn() {
    const double radius = Uniform(0.12, 0.3);
    const Vector2d centre(Uniform(-half_.x(), half_.x()), Uniform(-half_.y(), half_.y()));
    for (const Vector3d& point : path_) {
      if ((point.head<2>() - centre).norm() < config_.landmark_min_distance_m + radius) {
        return false;
      }
    }
    hall_.columns.push_back(
        {centre.cast<float>(), static_cast<float>(radius), MakeSurface(TextureKind::kLeaves, 0.95)});
    return true;
  }

  bool ThrowFloorBox() {
    const Vector3d size(Uniform(0.3, 1.2), Uniform(0.3, 1.2), Uniform(0.2, std::min(1.6, half_.z())));
    const Vector3d low(Uniform(-half_.x(), half_.x() - size.x()), Uniform(-half_.y(), half_.y() - size.y()),
                       -half_.z());
    return AddBox(low, low + size, stream_.Chance(0.7) ? TextureKind::kLeaves : TextureKind::kBricks);
  }

  bool ThrowPanel() {
    const int axis = stream_.Chance(half_.y() / (half_.x() + half_.y())) ? 0 : 1;
    const int along = 1 - axis;
    const double depth = Uniform(0.03, 0.4);
    Vector3d size;
    size[axis] = depth;
    size[along] = Uniform(0.4, 1.8);
    size.z() = Uniform(0.4, std::min(1.8, 1.5 * half_.z()));
    Vector3d low;
    low[axis] = stream_.Chance(0.5) ? -half_[axis] : half_[axis] - depth;
    low[along] = Uniform(-half_[along], half_[along] - size[along]);
    low.z() = Uniform(-half_.z(), half_.z() - size.z());
    return AddBox(low, low + size, stream_.Chance(0.8) ? TextureKind::kLeaves : TextureKind::kTiles);
  }

  bool ThrowBeam() {
    const Vector3d size(Uniform(0.2, 1.5), Uniform(0.2, 1.5), Uniform(0.05, 0.3));
    const Vector3d low(Uniform(-half_.x(), half_.x() - size.x()), Uniform(-half_.y(), half_.y() - size.y()),
                       half_.z() - size.z());
    return AddBox(low, low + size, stream_.Chance(0.5) ? TextureKind::kLeaves : TextureKind::kPanels);
  }

  const SimulatorConfig& config_;
  RandomStream stream_;
  Hall hall_;
  Vector3d half_;
  std::vector<Vector3d> path_;
};

/// Where the line p + t d enters (first) and leaves (second) a box.
std::pair<double, double> Cross(const HallBox& box, const Vector3d& p, const Vector3d& d) {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double low = (static_cast<double>(box.low[axis]) - p[axis]) / d[axis];
    const double high = (static_cast<double>(box.high[axis]) - p[axis]) / d[axis];
    enter = std::max(enter, std::min(low, high));
    leave = std::min(leave, std::max(low, high));
  }
  return {enter, leave};
}

}  // namespace

Vector3d MovingBox::Shift(double time_s) const {
  const double turn =
      2 * std::numbers::pi * time_s / static_cast<double>(period_s) + static_cast<double>(phase);
  return travel.cast<double>() * std::sin(turn);
}

HallRay Hall::Trace(const Vector3d& p_W, const Vector3d& direction_W, double time_s) const {
  const Vector3d p = p_W - origin_W;
  double nearest = Cross(room, p, direction_W).second;
  for (const HallBox& box : boxes) {
    const auto [enter, leave] = Cross(box, p, direction_W);
    if (enter > 0 && enter < leave) {
      nearest = std::min(nearest, enter);
    }
  }
  for (const HallColumn& column : columns) {
    const Vector2d to_centre = column.centre.cast<double>() - p.head<2>();
    const Vector2d d = direction_W.head<2>();
    const double along = d.dot(to_centre);
    const double radius = static_cast<double>(column.radius);
    const double discriminant = along * along - d.squaredNorm() * (to_centre.squaredNorm() - radius * radius);
    if (along > 0 && discriminant > 0) {
      nearest = std::min(nearest, (along - std::sqrt(discriminant)) / d.squaredNorm());
    }
  }
  HallRay ray{.distance = nearest, .moving = -1};
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const auto [enter, leave] = Cross(moving[i].box, p - moving[i].Shift(time_s), direction_W);
    if (enter > 0 && enter < leave && enter < ray.distance) {
      ray = {.distance = enter, .moving = static_cast<int>(i)};
    }
  }
  return ray;
}

Result<Hall> MakeHall(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                      std::uint64_t seed) {
  if (config.room_margin_m.minCoeff() < config.landmark_min_distance_m) {
    return Status::Config("room_margin_m: found " + std::to_string(config.room_margin_m.minCoeff()) +
                          " m, expected at least landmark_min_distance_m " +
                          std::to_string(config.landmark_min_distance_m) +
                          " with render.enabled: the walls of the hall are that far from the path");
  }
  Builder builder(config, SamplePath(trajectory, 0.1 * config.landmark_min_distance_m), seed);
  if (builder.ObjectCount() > kMaxObjects) {
    return Status::Config(
        "render.box_density_per_m2, panel_density_per_m2, column_density_per_m2, moving_density_per_m2: "
        "found " +
        std::to_string(builder.ObjectCount()) + " boxes and columns in a hall of this size, " +
        "expected at most " + std::to_string(kMaxObjects));
  }
  return builder.Build();
}

}  // namespace alidade
