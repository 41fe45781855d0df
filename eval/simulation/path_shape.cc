#include "eval/simulation/path_shape.h"

#include <cmath>
#include <numbers>

#include "core/random.h"

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

/// sum_i a_i sin(f_i u + c_i) with amplitudes 0.4, 0.3, 0.2, 0.1: within [-1, 1] and never periodic.
class Drift {
 public:
  explicit Drift(RandomStream* stream) {
    for (std::size_t i = 0; i < kTerms; ++i) {
      // Frequencies incommensurate by themselves; the jitter keeps the axes, and the seeds, from marching
      // together.
      frequency_[i] = kFrequency[i] * stream->Uniform(0.9, 1.1);
      offset_[i] = stream->Uniform(0, 2 * std::numbers::pi);
    }
  }

  [[nodiscard]] Jet At(const Jet& u) const {
    Jet sum;
    for (std::size_t i = 0; i < kTerms; ++i) {
      sum = sum + kAmplitude[i] * Sin(frequency_[i] * u + Jet{offset_[i], 0, 0});
    }
    return sum;
  }

 private:
  static constexpr std::size_t kTerms = 4;
  static constexpr std::array<double, kTerms> kAmplitude = {0.4, 0.3, 0.2, 0.1};
  static constexpr std::array<double, kTerms> kFrequency = {0.5, 0.866, 1.414, 2.236};

  std::array<double, kTerms> frequency_ = {};
  std::array<double, kTerms> offset_ = {};
};

/// An aimless walk in a box, looking around.
class Wander final : public PathShape {
 public:
  Wander(const SimulatorConfig& config, std::uint64_t seed) : Wander(config, RandomStream(seed, "path")) {}

  [[nodiscard]] Jet3 Position(const Jet& u) const override {
    return {half_length_m_ * x_.At(u), half_width_m_ * y_.At(u), height_m_ * z_.At(u)};
  }
  [[nodiscard]] Jet Yaw(const Jet& u) const override { return kYawRange * yaw_.At(u); }
  [[nodiscard]] Jet Pitch(const Jet& u) const override { return kPitchRange * pitch_.At(u); }
  [[nodiscard]] bool IsClosed() const override { return false; }

 private:
  static constexpr double kYawRange = 1.5 * std::numbers::pi;
  static constexpr double kPitchRange = 0.3;

  Wander(const SimulatorConfig& config, RandomStream stream)
      : half_length_m_(0.5 * config.length_m),
        half_width_m_(0.5 * config.width_m),
        height_m_(config.height_m),
        x_(&stream),
        y_(&stream),
        z_(&stream),
        yaw_(&stream),
        pitch_(&stream) {}

  double half_length_m_;
  double half_width_m_;
  double height_m_;
  Drift x_;
  Drift y_;
  Drift z_;
  Drift yaw_;
  Drift pitch_;
};

}  // namespace

double PathShape::SpeedOverPhase(double u) const {
  const Jet3 position = Position({u, 1, 0});
  return std::hypot(position[0].first, position[1].first, position[2].first);
}

double PathShape::PhaseAtArcLength(double arc_m) const {
  // An open curve is walked from end to end, in steps that are exact to about 1e-6.
  const int steps = IsClosed() ? 1 << 13 : 1 << 10;
  const double step = 2 * std::numbers::pi / steps;
  double laps = 0;
  double rest_m = arc_m;
  if (IsClosed()) {
    double lap_m = 0;
    for (int i = 0; i < steps; ++i) {
      lap_m += SpeedOverPhase((i + 0.5) * step) * step;
    }
    laps = std::floor(arc_m / lap_m);
    rest_m = arc_m - laps * lap_m;
  }
  for (double i = 0;; ++i) {
    const double step_m = SpeedOverPhase((i + 0.5) * step) * step;
    if (step_m >= rest_m) {
      return 2 * std::numbers::pi * laps + (i + rest_m / step_m) * step;
    }
    rest_m -= step_m;
  }
}

std::unique_ptr<PathShape> MakePathShape(const SimulatorConfig& config, std::uint64_t seed) {
  switch (config.trajectory) {
    case SimTrajectory::kEllipse:
      return std::make_unique<Ellipse>(config);
    case SimTrajectory::kWander:
      return std::make_unique<Wander>(config, seed);
    case SimTrajectory::kFigureEight:
    case SimTrajectory::kFile:
      break;
  }
  return std::make_unique<FigureEight>(config);
}

}  // namespace alidade
