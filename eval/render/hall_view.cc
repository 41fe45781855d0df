#include "eval/render/hall_view.h"

#include <algorithm>
#include <cmath>

namespace alidade {
namespace {

using Eigen::Vector3f;

/// Whether a sphere reaches into the cone (axis, half angle) from the origin: the angle to its centre is at
/// most the half angle and the angle under which it is seen.
bool Reaches(const Vector3f& axis, float cosine, float sine, const Vector3f& centre, float distance,
             float radius) {
  if (distance <= radius || cosine <= 0) {  // a cone beyond a half space is not worth the case
    return true;
  }
  const float seen_sine = radius / distance;
  const float seen_cosine = std::sqrt(1 - seen_sine * seen_sine);
  return axis.dot(centre) >= distance * (cosine * seen_cosine - sine * seen_sine);
}

}  // namespace

ViewTile ViewTile::Around(const std::vector<Vector3f>& rays) {
  ViewTile tile;
  Vector3f sum = Vector3f::Zero();
  for (const Vector3f& ray : rays) {
    sum += ray;
  }
  if (sum.norm() > 0) {
    tile.axis = sum.normalized();
  }
  float cosine = 1;
  for (const Vector3f& ray : rays) {
    if (!ray.isZero()) {
      cosine = std::min(cosine, tile.axis.dot(ray));
    }
  }
  // A hair wider: the cosine of a small angle is coarse in single precision.
  tile.cosine = cosine - 1e-6F;
  tile.sine = std::sqrt(std::max(0.0F, 1 - tile.cosine * tile.cosine));
  return tile;
}

HallView::HallView(const Hall& hall, const Pose& T_WC, const ViewTile& field, double time_s)
    : HallView(hall, T_WC.rotation.cast<float>(), (T_WC.translation - hall.origin_W).cast<float>(), field,
               time_s) {}

HallView HallView::InFloor(const Hall& hall, const Pose& T_WC, const ViewTile& field, double time_s) {
  Eigen::Matrix3f rotation = T_WC.rotation.cast<float>();
  rotation.row(2) *= -1;
  Vector3f origin = (T_WC.translation - hall.origin_W).cast<float>();
  origin.z() = 2 * hall.room.low.z() - origin.z();
  return {hall, rotation, origin, field, time_s};
}

HallView::HallView(const Hall& hall, const Eigen::Matrix3f& rotation, const Vector3f& origin,
                   const ViewTile& field, double time_s)
    : hall_(hall),
      R_WC_(rotation),
      origin_(origin),
      room_low_(hall.room.low - origin_),
      room_high_(hall.room.high - origin_) {
  const Vector3f axis_W = R_WC_ * field.axis;
  for (const HallBox& box : hall.boxes) {
    AddBox(box, Vector3f::Zero(), axis_W, field);
  }
  for (const MovingBox& moving : hall.moving) {
    AddBox(moving.box, moving.Shift(time_s).cast<float>(), axis_W, field);
  }
  for (const HallColumn& column : hall.columns) {
    const Eigen::Vector2f axis = column.centre - origin_.head<2>();
    columns_.push_back({axis.x(), axis.y(), axis.squaredNorm() - column.radius * column.radius, &column});
  }
}

void HallView::AddBox(const HallBox& box, const Vector3f& shift, const Vector3f& axis_W,
                      const ViewTile& field) {
  Box seen;
  seen.low = box.low + shift - origin_;
  seen.high = box.high + shift - origin_;
  seen.shift = shift;
  seen.centre = 0.5F * (seen.low + seen.high);
  seen.distance = seen.centre.norm();
  seen.radius = 0.5F * (box.high - box.low).norm();
  seen.box = &box;
  if (Reaches(axis_W, field.cosine, field.sine, seen.centre, seen.distance, seen.radius)) {
    boxes_.push_back(seen);
  }
}

void HallView::ListCandidates(const ViewTile& tile, std::vector<Candidate>* candidates) const {
  candidates->clear();
  const Vector3f axis_W = R_WC_ * tile.axis;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const Box& box = boxes_[i];
    if (Reaches(axis_W, tile.cosine, tile.sine, box.centre, box.distance, box.radius)) {
      candidates->push_back({box.distance - box.radius, static_cast<int>(i)});
    }
  }
  std::sort(candidates->begin(), candidates->end(), [](const Candidate& a, const Candidate& b) {
    return a.nearest != b.nearest ? a.nearest < b.nearest : a.box < b.box;
  });
}

HallHit HallView::OnFace(const HallBox& box, const Vector3f& shift, int axis, bool high, float distance,
                         const Vector3f& direction) const {
  HallHit hit;
  hit.place = origin_ + distance * direction;
  hit.direction = direction;
  const Vector3f place = hit.place - shift;
  hit.surface = &box.faces[static_cast<std::size_t>(2 * axis + (high ? 1 : 0))];
  hit.distance = distance;
  hit.cosine = std::abs(direction[axis]);
  hit.x_m = axis == 0 ? place.y() : place.x();
  hit.y_m = axis == 2 ? place.y() : place.z();
  return hit;
}

HallHit HallView::OnColumn(const HallColumn& column, float distance, const Vector3f& direction) const {
  HallHit hit;
  hit.place = origin_ + distance * direction;
  hit.direction = direction;
  const Eigen::Vector2f normal =
      (origin_.head<2>() + distance * direction.head<2>() - column.centre) / column.radius;
  hit.surface = &column.surface;
  hit.distance = distance;
  hit.cosine = std::abs(normal.dot(direction.head<2>()));
  hit.x_m = column.radius * std::atan2(normal.y(), normal.x());
  hit.y_m = hit.place.z();
  return hit;
}

HallHit HallView::Cast(const Vector3f& ray_C, const std::vector<Candidate>& candidates) const {
  const Vector3f direction = R_WC_ * ray_C;
  const Vector3f inverse = direction.cwiseInverse();
  // Inside the room the first wall ahead on any axis ends the ray.
  const Vector3f walls = (room_low_.cwiseProduct(inverse)).cwiseMax(room_high_.cwiseProduct(inverse));
  int axis = walls.x() < walls.y() ? 0 : 1;
  axis = walls[axis] < walls.z() ? axis : 2;
  float best = walls[axis];
  const HallBox* met = &hall_.room;
  Vector3f shift = Vector3f::Zero();
  for (const Candidate& candidate : candidates) {
    if (candidate.nearest > best) {
      break;
    }
    const Box& box = boxes_[static_cast<std::size_t>(candidate.box)];
    const Vector3f low = box.low.cwiseProduct(inverse);
    const Vector3f high = box.high.cwiseProduct(inverse);
    const Vector3f enters = low.cwiseMin(high);
    const Vector3f leaves = low.cwiseMax(high);
    const float enter = std::max(std::max(enters.x(), enters.y()), enters.z());
    const float leave = std::min(std::min(leaves.x(), leaves.y()), leaves.z());
    if (enter < leave && enter > 0 && enter < best) {
      best = enter;
      met = box.box;
      shift = box.shift;
      axis = enters.x() == enter ? 0 : (enters.y() == enter ? 1 : 2);
    }
  }
  const float flat = direction.x() * direction.x() + direction.y() * direction.y();
  const HallColumn* column_met = nullptr;
  for (const Column& column : columns_) {
    const float along = direction.x() * column.x + direction.y() * column.y;
    const float discriminant = along * along - flat * column.excess;
    if (along > 0 && discriminant > 0) {
      const float distance = (along - std::sqrt(discriminant)) / flat;
      if (distance < best) {
        best = distance;
        column_met = column.column;
      }
    }
  }
  if (column_met != nullptr) {
    return OnColumn(*column_met, best, direction);
  }
  // The room is left through its far face, a box entered through its near one.
  const bool high = (direction[axis] > 0) == (met == &hall_.room);
  return OnFace(*met, shift, axis, high, best, direction);
}

}  // namespace alidade
