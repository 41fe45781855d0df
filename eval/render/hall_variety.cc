#include "eval/render/hall_variety.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "eval/render/render_texture.h"

namespace alidade {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kMaxThrows = 60;
constexpr double kStepS = 0.1;  // of the motion; at 1 m/s a tenth of the least clearance in use

bool Overlap(const Vector3f& low, const Vector3f& high, const HallBox& box) {
  return (low.array() < box.high.array()).all() && (box.low.array() < high.array()).all();
}

bool Overlap(const Vector3f& low, const Vector3f& high, const HallColumn& column) {
  const Eigen::Vector2f nearest = column.centre.cwiseMax(low.head<2>()).cwiseMin(high.head<2>());
  return (nearest - column.centre).norm() < column.radius;
}

class MovingBoxes {
 public:
  MovingBoxes(const SimulatorConfig& config, const ContinuousTrajectory& trajectory, std::uint64_t seed,
              Hall* hall)
      : config_(config), stream_(seed, "render.moving"), hall_(hall) {
    for (int step = 0; step * kStepS <= trajectory.DurationSeconds(); ++step) {
      path_.push_back(trajectory.At(step * kStepS).nav.p_WB - hall->origin_W);
    }
  }

  bool ThrowOne() {
    MovingBox moving = Draw();
    if (!IsFree(moving) || !IsClear(moving)) {
      return false;
    }
    hall_->moving.push_back(moving);
    return true;
  }

 private:
  float Uniform(double low, double high) { return static_cast<float>(stream_.Uniform(low, high)); }

  MovingBox Draw() {
    const HallBox& room = hall_->room;
    const Vector3f size(Uniform(0.3, 0.8), Uniform(0.3, 0.8),
                        std::min(Uniform(0.8, 1.8), 0.9F * (room.high.z() - room.low.z())));
    const Vector3f middle(Uniform(static_cast<double>(room.low.x()), static_cast<double>(room.high.x())),
                          Uniform(static_cast<double>(room.low.y()), static_cast<double>(room.high.y())),
                          room.low.z() + 0.5F * size.z());
    MovingBox moving;
    moving.box.low = middle - 0.5F * size;
    moving.box.high = middle + 0.5F * size;
    const float heading = Uniform(0, 2 * std::numbers::pi);
    const float reach = Uniform(0.5, 2);
    moving.travel = reach * Vector3f(std::cos(heading), std::sin(heading), 0);
    const float speed = Uniform(0.4, 1) * static_cast<float>(config_.render.moving_speed_mps);
    moving.period_s = 2 * std::numbers::pi_v<float> * reach / speed;
    moving.phase = Uniform(0, 2 * std::numbers::pi);
    for (Surface& face : moving.box.faces) {
      face.texture = static_cast<int>(TextureKind::kLeaves);
      face.offset_m = {Uniform(0, 100), Uniform(0, 100)};
      face.shade = Uniform(0.75, 1.1);
    }
    return moving;
  }

  /// Whether its sweep stays in the room and meets nothing that stands.
  [[nodiscard]] bool IsFree(const MovingBox& moving) const {
    const Vector3f low = moving.box.low - moving.travel.cwiseAbs();
    const Vector3f high = moving.box.high + moving.travel.cwiseAbs();
    const HallBox& room = hall_->room;
    return (low.head<2>().array() > room.low.head<2>().array()).all() &&
           (high.head<2>().array() < room.high.head<2>().array()).all() &&
           std::none_of(hall_->boxes.begin(), hall_->boxes.end(),
                        [&](const HallBox& box) { return Overlap(low, high, box); }) &&
           std::none_of(hall_->columns.begin(), hall_->columns.end(),
                        [&](const HallColumn& column) { return Overlap(low, high, column); });
  }

  /// Whether it keeps away from the body at all times.
  [[nodiscard]] bool IsClear(const MovingBox& moving) const {
    const Vector3d low = moving.box.low.cast<double>(), high = moving.box.high.cast<double>();
    for (std::size_t i = 0; i < path_.size(); ++i) {
      const Vector3d seen = path_[i] - moving.Shift(kStepS * static_cast<double>(i));
      if ((seen - seen.cwiseMax(low).cwiseMin(high)).norm() < config_.landmark_min_distance_m) {
        return false;
      }
    }
    return true;
  }

  const SimulatorConfig& config_;
  RandomStream stream_;
  Hall* hall_;
  std::vector<Vector3d> path_;  ///< of the body, in the hall, every kStepS
};

}  // namespace

void ThrowMovingBoxes(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                      std::uint64_t seed, Hall* hall) {
  const Vector3f size = hall->room.high - hall->room.low;
  const double count = config.render.moving_density_per_m2 * static_cast<double>(size.x() * size.y());
  if (count == 0) {
    return;
  }
  MovingBoxes boxes(config, trajectory, seed, hall);
  for (int i = 0; i < static_cast<int>(std::lround(count)); ++i) {
    for (int tries = 0; tries < kMaxThrows && !boxes.ThrowOne(); ++tries) {
    }
  }
}

void VaryTextures(const RenderConfig& config, std::uint64_t seed, Hall* hall) {
  RandomStream stream(seed, "render.variety");
  const auto vary = [&](Surface* surface) {
    const bool repeats = stream.Chance(config.repetitive_share);
    const bool bare = stream.Chance(config.bare_share);
    if (bare) {
      surface->texture = static_cast<int>(TextureKind::kPaint);
    } else if (repeats) {
      surface->texture = static_cast<int>(TextureKind::kMotif);
    }
  };
  const auto vary_box = [&](HallBox* box) {
    std::for_each(box->faces.begin(), box->faces.end(), [&](Surface& face) { vary(&face); });
  };
  vary_box(&hall->room);
  std::for_each(hall->boxes.begin(), hall->boxes.end(), [&](HallBox& box) { vary_box(&box); });
  std::for_each(hall->columns.begin(), hall->columns.end(),
                [&](HallColumn& column) { vary(&column.surface); });
  std::for_each(hall->moving.begin(), hall->moving.end(), [&](MovingBox& moving) { vary_box(&moving.box); });
}

}  // namespace alidade
