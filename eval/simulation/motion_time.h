#pragma once

#include "eval/simulation/jet.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// When an analytic trajectory moves: rest at the start, pauses, and changes of its speed.
///
/// The warped time tau(t) is t without rest and pauses. With rest, d tau / dt is 0 during rest_s and rises to
/// 1 within rest_ramp_s by the polynomial of degree 9 whose first four derivatives vanish at both ends, so
/// acceleration stays three times continuously differentiable. From then on every pause_period_s ends in a
/// pause: d tau / dt falls to 0 within rest_ramp_s, stays there for pause_s, and rises again.
class MotionTime {
 public:
  /// Keeps a copy. Precondition: config.Validate() is ok.
  explicit MotionTime(const SimulatorConfig& config) : config_(config) {}

  /// tau [s], `time_s` after the start of the sequence.
  [[nodiscard]] Jet Moving(double time_s) const { return Paused(Rested(time_s)); }
  /// Where the path is [s], of Moving's answer: d / d tau = 1 + speed_variation sin(2 pi tau /
  /// speed_period_s).
  [[nodiscard]] Jet PathTime(const Jet& tau) const;
  /// Yaw of the turns in the pauses so far [rad]: a smooth step of pause_turn_rad in each.
  [[nodiscard]] Jet PauseTurn(double time_s) const;

 private:
  [[nodiscard]] Jet Rested(double time_s) const;
  [[nodiscard]] Jet Paused(const Jet& rested) const;
  [[nodiscard]] bool HasPauses() const { return config_.pause_s > 0; }
  /// What each period has before its pause's ramp.
  [[nodiscard]] double MovingSeconds() const {
    return config_.pause_period_s - config_.pause_s - 2 * config_.rest_ramp_s;
  }

  SimulatorConfig config_;
};

}  // namespace alidade
