#include "eval/sim_trajectory.h"

#include <array>
#include <cmath>
#include <numbers>

namespace alidade {
namespace {

/// A function of time with its first and second derivative.
struct Jet {
  double value = 0;
  double first = 0;
  double second = 0;
};

Jet operator+(const Jet& a, const Jet& b) {
  return {a.value + b.value, a.first + b.first, a.second + b.second};
}
Jet operator*(double s, const Jet& a) {
  return {s * a.value, s * a.first, s * a.second};
}

Jet Sin(const Jet& a) {
  const double s = std::sin(a.value);
  const double c = std::cos(a.value);
  return {s, c * a.first, c * a.second - s * a.first * a.first};
}

Jet Cos(const Jet& a) {
  const double s = std::sin(a.value);
  const double c = std::cos(a.value);
  return {c, -s * a.first, -s * a.second - c * a.first * a.first};
}

/// sqrt(x^2 + y^2), not both zero.
Jet Hypot(const Jet& x, const Jet& y) {
  const double r = std::hypot(x.value, y.value);
  const double first = (x.value * x.first + y.value * y.first) / r;
  const double second =
      (x.first * x.first + y.first * y.first + x.value * x.second + y.value * y.second - first * first) / r;
  return {r, first, second};
}

/// atan2(y, x), not both zero.
Jet Atan2(const Jet& y, const Jet& x) {
  const double square = x.value * x.value + y.value * y.value;
  const double first = (x.value * y.first - y.value * x.first) / square;
  const double second =
      (x.value * y.second - y.value * x.second - 2 * (x.value * x.first + y.value * y.first) * first) /
      square;
  return {std::atan2(y.value, x.value), first, second};
}

using Jet3 = std::array<Jet, 3>;

/// Integral of the smooth step 126 x^5 - 420 x^6 + 540 x^7 - 315 x^8 + 70 x^9 from 0 to x in [0, 1], with the
/// step and its slope as derivatives with respect to x.
Jet SmoothRamp(double x) {
  const double x2 = x * x;
  const double x4 = x2 * x2;
  const double rest = 1 - x;
  return {x4 * x2 * (21 + x * (-60 + x * (67.5 + x * (-35 + x * 7)))),
          x4 * x * (126 + x * (-420 + x * (540 + x * (-315 + x * 70)))),
          630 * x4 * rest * rest * rest * rest};
}

class SimulatedTrajectory final : public ContinuousTrajectory {
 public:
  explicit SimulatedTrajectory(const SimulatorConfig& config) : config_(config) {
    const double moving_s = WarpedTime(config_.duration_s).value;
    phase_rate_ = PhaseAtArcLength(config_.path_m) / moving_s;
  }

  [[nodiscard]] double DurationSeconds() const override { return config_.duration_s; }

  [[nodiscard]] Kinematics At(double time_s) const override {
    const Jet tau = WarpedTime(time_s);
    const Jet phase = phase_rate_ * tau;
    const Jet3 position = Position(phase);
    Kinematics motion;
    for (int i = 0; i < 3; ++i) {
      const Jet& axis = position[static_cast<std::size_t>(i)];
      motion.nav.p_WB[i] = axis.value;
      motion.nav.v_WB[i] = axis.first;
      motion.acceleration_W[i] = axis.second;
    }
    SetAttitude(tau, Tangent(phase), &motion);
    return motion;
  }

 private:
  /// tau(t) with derivatives.
  [[nodiscard]] Jet WarpedTime(double time_s) const {
    if (config_.rest_s <= 0) {
      return {time_s, 1, 0};
    }
    const double ramp = config_.rest_ramp_s;
    const double x = (time_s - config_.rest_s) / ramp;
    if (x <= 0) {
      return {};
    }
    if (x >= 1) {
      return {time_s - config_.rest_s - 0.5 * ramp, 1, 0};
    }
    const Jet step = SmoothRamp(x);
    return {ramp * step.value, step.first, step.second / ramp};
  }

  [[nodiscard]] Jet3 Position(const Jet& u) const {
    const Jet z = config_.height_m * Sin(3 * u);
    if (config_.trajectory == SimTrajectory::kEllipse) {
      return {0.5 * config_.length_m * Cos(u), 0.5 * config_.width_m * Sin(u), z};
    }
    return {0.5 * config_.length_m * Sin(u), 0.5 * config_.width_m * Sin(2 * u), z};
  }

  /// d Position / d u: the direction of travel, defined even at rest. Its horizontal part never vanishes.
  [[nodiscard]] Jet3 Tangent(const Jet& u) const {
    const Jet z = 3 * config_.height_m * Cos(3 * u);
    if (config_.trajectory == SimTrajectory::kEllipse) {
      return {-0.5 * config_.length_m * Sin(u), 0.5 * config_.width_m * Cos(u), z};
    }
    return {0.5 * config_.length_m * Cos(u), config_.width_m * Cos(2 * u), z};
  }

  /// R_WB = Rz(yaw) Ry(pitch) Rx(roll) and its rate in the body frame.
  void SetAttitude(const Jet& tau, const Jet3& tangent, Kinematics* motion) const {
    const Jet wobble_phase = 2 * std::numbers::pi * config_.wobble_hz * tau;
    const Jet roll = config_.wobble_rad * Sin(wobble_phase);
    const Jet pitch =
        -1 * Atan2(tangent[2], Hypot(tangent[0], tangent[1])) + config_.wobble_rad * Sin(0.77 * wobble_phase);
    const Jet yaw = Atan2(tangent[1], tangent[0]) + 0.5 * config_.wobble_rad * Sin(0.61 * wobble_phase);

    using Eigen::Vector3d;
    motion->nav.R_WB = so3::Exp(yaw.value * Vector3d::UnitZ()) * so3::Exp(pitch.value * Vector3d::UnitY()) *
                       so3::Exp(roll.value * Vector3d::UnitX());
    const double sin_roll = std::sin(roll.value);
    const double cos_roll = std::cos(roll.value);
    const double cos_pitch = std::cos(pitch.value);
    motion->angular_rate_B << roll.first - yaw.first * std::sin(pitch.value),
        pitch.first * cos_roll + yaw.first * sin_roll * cos_pitch,
        -pitch.first * sin_roll + yaw.first * cos_roll * cos_pitch;
  }

  [[nodiscard]] double SpeedOverPhase(double u) const {
    const Jet3 tangent = Tangent({u, 0, 0});
    return std::hypot(tangent[0].value, tangent[1].value, tangent[2].value);
  }

  /// The phase at which the path from phase 0 is `arc_m` long. The midpoint rule converges spectrally over
  /// whole laps; the last, partial lap is walked in steps, exact to about 1e-7 of a lap.
  [[nodiscard]] double PhaseAtArcLength(double arc_m) const {
    constexpr int kSteps = 1 << 13;
    constexpr double kStep = 2 * std::numbers::pi / kSteps;
    double lap_m = 0;
    for (int i = 0; i < kSteps; ++i) {
      lap_m += SpeedOverPhase((i + 0.5) * kStep) * kStep;
    }
    const double laps = std::floor(arc_m / lap_m);
    double rest_m = arc_m - laps * lap_m;
    for (int i = 0; i < kSteps; ++i) {
      const double step_m = SpeedOverPhase((i + 0.5) * kStep) * kStep;
      if (step_m >= rest_m) {
        return 2 * std::numbers::pi * laps + (i + rest_m / step_m) * kStep;
      }
      rest_m -= step_m;
    }
    return 2 * std::numbers::pi * (laps + 1);
  }

  SimulatorConfig config_;
  double phase_rate_ = 0;  ///< d u / d tau [rad/s]
};

}  // namespace

std::unique_ptr<ContinuousTrajectory> MakeSimTrajectory(const SimulatorConfig& config) {
  return std::make_unique<SimulatedTrajectory>(config);
}

}  // namespace alidade
