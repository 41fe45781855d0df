#include "eval/simulation/sim_trajectory.h"

#include <cmath>
#include <numbers>

#include "eval/simulation/path_shape.h"

namespace alidade {
namespace {

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
  SimulatedTrajectory(const SimulatorConfig& config, std::uint64_t seed)
      : config_(config), shape_(MakePathShape(config, seed)) {
    const double moving_s = WarpedTime(config_.duration_s).value;
    phase_rate_ = shape_->PhaseAtArcLength(config_.path_m) / moving_s;
  }

  [[nodiscard]] double DurationSeconds() const override { return config_.duration_s; }

  [[nodiscard]] Kinematics At(double time_s) const override {
    const Jet tau = WarpedTime(time_s);
    const Jet phase = phase_rate_ * tau;
    const Jet3 position = shape_->Position(phase);
    Kinematics motion;
    for (int i = 0; i < 3; ++i) {
      const Jet& axis = position[static_cast<std::size_t>(i)];
      motion.nav.p_WB[i] = axis.value;
      motion.nav.v_WB[i] = axis.first;
      motion.acceleration_W[i] = axis.second;
    }
    SetAttitude(tau, phase, &motion);
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

  /// R_WB = Rz(yaw) Ry(pitch) Rx(roll) and its rate in the body frame.
  void SetAttitude(const Jet& tau, const Jet& phase, Kinematics* motion) const {
    const Jet wobble_phase = 2 * std::numbers::pi * config_.wobble_hz * tau;
    const Jet roll = config_.wobble_rad * Sin(wobble_phase);
    const Jet pitch = shape_->Pitch(phase) + config_.wobble_rad * Sin(0.77 * wobble_phase);
    const Jet yaw = shape_->Yaw(phase) + 0.5 * config_.wobble_rad * Sin(0.61 * wobble_phase);

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

  SimulatorConfig config_;
  std::unique_ptr<PathShape> shape_;
  double phase_rate_ = 0;  ///< d u / d tau [rad/s]
};

}  // namespace

std::unique_ptr<ContinuousTrajectory> MakeSimTrajectory(const SimulatorConfig& config, std::uint64_t seed) {
  return std::make_unique<SimulatedTrajectory>(config, seed);
}

}  // namespace alidade
