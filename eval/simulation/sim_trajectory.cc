#include "eval/simulation/sim_trajectory.h"

#include <cmath>
#include <numbers>

#include "eval/simulation/make_path_shape.h"
#include "eval/simulation/motion_time.h"

namespace alidade {
namespace {

/// Roll, pitch and yaw over time: R_WB = Rz(yaw) Ry(pitch) Rx(roll).
struct Attitude {
  Jet roll, pitch, yaw;

  [[nodiscard]] Eigen::Matrix3d Rotation() const {
    using Eigen::Vector3d;
    return so3::Exp(yaw.value * Vector3d::UnitZ()) * so3::Exp(pitch.value * Vector3d::UnitY()) *
           so3::Exp(roll.value * Vector3d::UnitX());
  }
  /// In the body frame [rad/s].
  [[nodiscard]] Eigen::Vector3d Rate() const {
    const double sin_roll = std::sin(roll.value);
    const double cos_roll = std::cos(roll.value);
    const double cos_pitch = std::cos(pitch.value);
    return {roll.first - yaw.first * std::sin(pitch.value),
            pitch.first * cos_roll + yaw.first * sin_roll * cos_pitch,
            -pitch.first * sin_roll + yaw.first * cos_roll * cos_pitch};
  }
  /// Derivative of Rate [rad/s^2].
  [[nodiscard]] Eigen::Vector3d Acceleration() const {
    const Jet sin_roll = Sin(roll), cos_roll = Cos(roll), sin_pitch = Sin(pitch), cos_pitch = Cos(pitch);
    const Jet roll_rate = Slope(roll), pitch_rate = Slope(pitch), yaw_rate = Slope(yaw);
    return {(roll_rate + -1 * (yaw_rate * sin_pitch)).first,
            (pitch_rate * cos_roll + yaw_rate * sin_roll * cos_pitch).first,
            (-1 * (pitch_rate * sin_roll) + yaw_rate * cos_roll * cos_pitch).first};
  }

 private:
  /// The derivative as a function, whose second derivative is unknown and unused.
  static Jet Slope(const Jet& angle) { return {angle.first, angle.second, 0}; }
};

class SimulatedTrajectory final : public ContinuousTrajectory {
 public:
  SimulatedTrajectory(const SimulatorConfig& config, std::uint64_t seed)
      : config_(config), time_(config), shape_(MakePathShape(config, seed)) {
    const double moving_s = time_.PathTime(time_.Moving(config_.duration_s)).value;
    phase_rate_ = shape_->PhaseRate(config_.path_m, moving_s);
  }

  [[nodiscard]] double DurationSeconds() const override { return config_.duration_s; }

  [[nodiscard]] Kinematics At(double time_s) const override {
    const Jet tau = time_.Moving(time_s);
    const Jet phase = phase_rate_ * time_.PathTime(tau);
    const Jet3 position = shape_->Position(phase);
    const Attitude attitude = AttitudeAt(tau, phase, time_.PauseTurn(time_s));
    Kinematics motion;
    for (int i = 0; i < 3; ++i) {
      const Jet& axis = position[static_cast<std::size_t>(i)];
      motion.nav.p_WB[i] = axis.value;
      motion.nav.v_WB[i] = axis.first;
      motion.acceleration_W[i] = axis.second;
    }
    motion.nav.R_WB = attitude.Rotation();
    motion.angular_rate_B = attitude.Rate();
    if (config_.path_point == SimPathPoint::kCamera) {
      MoveFromCameraToBody(attitude.Acceleration(), &motion);
    }
    return motion;
  }

 private:
  [[nodiscard]] Attitude AttitudeAt(const Jet& tau, const Jet& phase, const Jet& pause_turn) const {
    const Jet wobble_phase = 2 * std::numbers::pi * config_.wobble_hz * tau;
    return {config_.wobble_rad * Sin(wobble_phase),
            shape_->Pitch(phase) + config_.wobble_rad * Sin(0.77 * wobble_phase),
            shape_->Yaw(phase) + 0.5 * config_.wobble_rad * Sin(0.61 * wobble_phase) +
                config_.yaw_rate_radps * tau + pause_turn};
  }

  /// Position, velocity and acceleration are the camera's: makes them the body's, on the other end of the
  /// lever arm. `angular_acceleration_B` is of B against W, in B.
  void MoveFromCameraToBody(const Eigen::Vector3d& angular_acceleration_B, Kinematics* motion) const {
    const Eigen::Vector3d& p_BC = config_.camera_lever_arm_m;
    const Eigen::Vector3d& w_B = motion->angular_rate_B;
    const Eigen::Matrix3d& R_WB = motion->nav.R_WB;
    motion->nav.p_WB -= R_WB * p_BC;
    motion->nav.v_WB -= R_WB * w_B.cross(p_BC);
    motion->acceleration_W -= R_WB * (angular_acceleration_B.cross(p_BC) + w_B.cross(w_B.cross(p_BC)));
  }

  SimulatorConfig config_;
  MotionTime time_;
  std::unique_ptr<PathShape> shape_;
  double phase_rate_ = 0;  ///< d u / d PathTime [rad/s]
};

}  // namespace

std::unique_ptr<ContinuousTrajectory> MakeSimTrajectory(const SimulatorConfig& config, std::uint64_t seed) {
  return std::make_unique<SimulatedTrajectory>(config, seed);
}

}  // namespace alidade
