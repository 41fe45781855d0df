#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/navigation_state.h"
#include "eval/render/render_hall.h"

namespace alidade {

/// A rectangle of pixels and a cone around all of its rays.
struct ViewTile {
  int x = 0, y = 0;                                 ///< upper left pixel
  int right = 0, bottom = 0;                        ///< beyond its last pixel
  Eigen::Vector3f axis = Eigen::Vector3f::UnitZ();  ///< of the cone, camera frame
  float cosine = 1, sine = 0;                       ///< of the cone's half angle

  /// A tile without pixels yet; the cone holds the unit vectors `rays` (zero: no ray).
  static ViewTile Around(const std::vector<Eigen::Vector3f>& rays);
};

/// What a ray met.
struct HallHit {
  const Surface* surface = nullptr;
  float distance = 0;                                   ///< [m] along the ray
  float cosine = 1;                                     ///< of the angle between ray and normal
  float x_m = 0, y_m = 0;                               ///< place on the surface
  Eigen::Vector3f place = Eigen::Vector3f::Zero();      ///< in the hall
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();  ///< of the ray, unit vector in W
};

/// The hall seen from one place at one time, relative to the camera, without objects behind it.
class HallView {
 public:
  /// A box that rays of a tile may meet.
  struct Candidate {
    float nearest = 0;  ///< no point of it is nearer [m]
    int box = 0;
  };

  /// field: a cone around all rays of the camera. time_s: hall time.
  HallView(const Hall& hall, const Pose& T_WC, const ViewTile& field, double time_s);

  /// What the floor mirrors into the camera: the hall seen from the camera's mirror image below the floor, by
  /// rays that are mirrored too. Of its hits only those of rays that meet the floor count; distances are
  /// those of the whole path.
  [[nodiscard]] static HallView InFloor(const Hall& hall, const Pose& T_WC, const ViewTile& field,
                                        double time_s);

  /// The boxes in the tile's cone, nearest first.
  void ListCandidates(const ViewTile& tile, std::vector<Candidate>* candidates) const;
  /// What the ray along the unit vector `ray_C` (camera frame) meets first: room, candidate or column.
  [[nodiscard]] HallHit Cast(const Eigen::Vector3f& ray_C, const std::vector<Candidate>& candidates) const;

 private:
  /// rotation: of the rays, or that and a reflection. origin: in the hall.
  HallView(const Hall& hall, const Eigen::Matrix3f& rotation, const Eigen::Vector3f& origin,
           const ViewTile& field, double time_s);

  struct Box {
    Eigen::Vector3f low, high;  ///< from the camera, axes of W
    Eigen::Vector3f shift;      ///< from where `box` stands in the hall
    Eigen::Vector3f centre;     ///< of the sphere around it
    float distance = 0, radius = 0;
    const HallBox* box = nullptr;
  };
  struct Column {
    float x = 0, y = 0;  ///< axis, from the camera
    float excess = 0;    ///< squared distance less squared radius
    const HallColumn* column = nullptr;
  };

  void AddBox(const HallBox& box, const Eigen::Vector3f& shift, const Eigen::Vector3f& axis_W,
              const ViewTile& field);
  /// A column at `distance` along `direction`.
  [[nodiscard]] HallHit OnColumn(const HallColumn& column, float distance,
                                 const Eigen::Vector3f& direction) const;
  /// A face of `box` that is displaced by `shift`.
  [[nodiscard]] HallHit OnFace(const HallBox& box, const Eigen::Vector3f& shift, int axis, bool high,
                               float distance, const Eigen::Vector3f& direction) const;

  const Hall& hall_;
  Eigen::Matrix3f R_WC_;
  Eigen::Vector3f origin_;  ///< of the camera in the hall
  Eigen::Vector3f room_low_, room_high_;
  std::vector<Box> boxes_;
  std::vector<Column> columns_;
};

}  // namespace alidade
