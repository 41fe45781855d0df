#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/status.h"
#include "core/time.h"
#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// How one face looks.
struct Surface {
  int texture = 0;                                     ///< a TextureKind
  Eigen::Vector2f offset_m = Eigen::Vector2f::Zero();  ///< so that no two faces show the same piece
  float shade = 1;                                     ///< light that falls on it
};

/// An axis-aligned box. Faces: x low, x high, y low, y high, z low, z high.
struct HallBox {
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();
  std::array<Surface, 6> faces;
};

/// A round column from floor to ceiling.
struct HallColumn {
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();
  float radius = 0;
  Surface surface;
};

/// A box that swings along a line: at hall time t it is displaced by travel sin(2 pi t / period + phase).
struct MovingBox {
  HallBox box;  ///< in the middle of the line
  Eigen::Vector3f travel = Eigen::Vector3f::Zero();
  float period_s = 1;
  float phase = 0;

  [[nodiscard]] Eigen::Vector3d Shift(double time_s) const;
};

/// What a ray met first.
struct HallRay {
  double distance = 0;  ///< [m]
  int moving = -1;      ///< of Hall::moving; -1: something that stands
};

/// A closed hall: walls, floor and ceiling seen from inside (`room`), boxes and columns in it. Coordinates
/// are metres from `origin_W` along the axes of W, so that single precision suffices wherever the hall
/// stands. Hall time is seconds since `epoch_ns`; it only concerns `moving`.
struct Hall {
  Eigen::Vector3d origin_W = Eigen::Vector3d::Zero();
  HallBox room;
  std::vector<HallBox> boxes;
  std::vector<HallColumn> columns;
  std::vector<MovingBox> moving;
  TimeNs epoch_ns = 0;  ///< in the camera's clock

  /// The first surface along the unit vector `direction_W` from `p_W`, inside the hall, at hall time
  /// `time_s`. In double precision and without the renderer's short cuts: what its images are tested against.
  [[nodiscard]] HallRay Trace(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                              double time_s) const;
  /// Its distance [m].
  [[nodiscard]] double Distance(const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W,
                                double time_s = 0) const {
    return Trace(p_W, direction_W, time_s).distance;
  }
};

/// A hall around the path of the body: its bounding box extended by room_margin_m. Boxes on the floor, panels
/// on the walls, beams under the ceiling and columns are thrown at the densities of config.render; what would
/// be nearer to the path than landmark_min_distance_m is thrown again, a few times. What
/// eval/render/hall_variety.h adds is not in it yet. Errors (kConfig): the margin is smaller than that
/// distance; more objects than 2e4.
Result<Hall> MakeHall(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                      std::uint64_t seed);

}  // namespace alidade
