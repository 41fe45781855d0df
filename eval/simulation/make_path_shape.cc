#include "eval/simulation/make_path_shape.h"

#include <numbers>

#include "eval/simulation/path_wander.h"

namespace alidade {
namespace {

/// A closed curve travelled along its tangent, whose horizontal part never vanishes.
class ClosedShape : public PathShape {
 public:
  explicit ClosedShape(const SimulatorConfig& config)
      : half_length_m_(0.5 * config.length_m),
        half_width_m_(0.5 * config.width_m),
        height_m_(config.height_m) {}

  [[nodiscard]] Jet Yaw(const Jet& u) const override {
    const Jet3 tangent = Tangent(u);
    return Atan2(tangent[1], tangent[0]);
  }
  [[nodiscard]] Jet Pitch(const Jet& u) const override {
    const Jet3 tangent = Tangent(u);
    return -1 * Atan2(tangent[2], Hypot(tangent[0], tangent[1]));
  }
  [[nodiscard]] bool IsClosed() const override { return true; }

 protected:
  /// d Position / d u: the direction of travel, defined even at rest.
  [[nodiscard]] virtual Jet3 Tangent(const Jet& u) const = 0;

  double half_length_m_;
  double half_width_m_;
  double height_m_;
};

class FigureEight final : public ClosedShape {
 public:
  using ClosedShape::ClosedShape;

  [[nodiscard]] Jet3 Position(const Jet& u) const override {
    return {half_length_m_ * Sin(u), half_width_m_ * Sin(2 * u), height_m_ * Sin(3 * u)};
  }

 protected:
  [[nodiscard]] Jet3 Tangent(const Jet& u) const override {
    return {half_length_m_ * Cos(u), 2 * half_width_m_ * Cos(2 * u), 3 * height_m_ * Cos(3 * u)};
  }
};

class Ellipse final : public ClosedShape {
 public:
  using ClosedShape::ClosedShape;

  [[nodiscard]] Jet3 Position(const Jet& u) const override {
    return {half_length_m_ * Cos(u), half_width_m_ * Sin(u), height_m_ * Sin(3 * u)};
  }

 protected:
  [[nodiscard]] Jet3 Tangent(const Jet& u) const override {
    return {-half_length_m_ * Sin(u), half_width_m_ * Cos(u), 3 * height_m_ * Cos(3 * u)};
  }
};

/// Straight along x; the phase runs from 0 to 2 pi over the whole path.
class Line final : public PathShape {
 public:
  explicit Line(const SimulatorConfig& config) : metres_per_radian_(config.path_m / (2 * std::numbers::pi)) {}

  [[nodiscard]] Jet3 Position(const Jet& u) const override { return {metres_per_radian_ * u, {}, {}}; }
  [[nodiscard]] Jet Yaw(const Jet&) const override { return {}; }
  [[nodiscard]] Jet Pitch(const Jet&) const override { return {}; }
  [[nodiscard]] bool IsClosed() const override { return false; }

 private:
  double metres_per_radian_;
};

/// A helix, travelled along its tangent, whose radius and height grow evenly.
class Spiral final : public PathShape {
 public:
  explicit Spiral(const SimulatorConfig& config)
      : radius_m_(0.5 * config.length_m),
        widening_m_(config.spiral_widening_m / (2 * std::numbers::pi)),
        climb_m_(config.spiral_climb_m / (2 * std::numbers::pi)) {}

  [[nodiscard]] Jet3 Position(const Jet& u) const override {
    const Jet radius = Radius(u);
    return {radius * Cos(u), radius * Sin(u), climb_m_ * u};
  }
  [[nodiscard]] Jet Yaw(const Jet& u) const override {
    // Of the tangent (r' cos u - r sin u, r' sin u + r cos u); the angle between it and the circle's vanishes
    // as the radius grows, and is never cut.
    return u + -1 * Atan2({widening_m_, 0, 0}, Radius(u)) + Jet{0.5 * std::numbers::pi, 0, 0};
  }
  [[nodiscard]] Jet Pitch(const Jet& u) const override {
    return -1 * Atan2({climb_m_, 0, 0}, Hypot({widening_m_, 0, 0}, Radius(u)));
  }
  [[nodiscard]] bool IsClosed() const override { return false; }

 private:
  [[nodiscard]] Jet Radius(const Jet& u) const { return Jet{radius_m_, 0, 0} + widening_m_ * u; }

  double radius_m_;
  double widening_m_;  ///< a radian
  double climb_m_;     ///< a radian
};

}  // namespace

std::unique_ptr<PathShape> MakePathShape(const SimulatorConfig& config, std::uint64_t seed) {
  switch (config.trajectory) {
    case SimTrajectory::kEllipse:
      return std::make_unique<Ellipse>(config);
    case SimTrajectory::kWander:
      return MakeWander(config, seed);
    case SimTrajectory::kHover:
      return MakeHover(config, seed);
    case SimTrajectory::kRotation:
      return MakeRotation(config, seed);
    case SimTrajectory::kLine:
      return std::make_unique<Line>(config);
    case SimTrajectory::kSpiral:
      return std::make_unique<Spiral>(config);
    case SimTrajectory::kFigureEight:
    case SimTrajectory::kFile:
      break;
  }
  return std::make_unique<FigureEight>(config);
}

}  // namespace alidade
