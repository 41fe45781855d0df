#include "eval/simulation/motion_time.h"

#include <cmath>
#include <numbers>

namespace alidade {
namespace {

/// The smooth step 126 x^5 - 420 x^6 + 540 x^7 - 315 x^8 + 70 x^9 over x in [0, 1] with its derivatives.
Jet SmoothStep(double x) {
  const double x4 = x * x * (x * x);
  const double rest = 1 - x;
  return {x4 * x * (126 + x * (-420 + x * (540 + x * (-315 + x * 70)))), 630 * x4 * rest * rest * rest * rest,
          2520 * x * x * x * rest * rest * rest * (1 - 2 * x)};
}

/// Integral of the smooth step from 0 to x, 1/2 at 1, with the step and its slope as derivatives.
Jet SmoothRamp(double x) {
  const double x2 = x * x;
  const Jet step = SmoothStep(x);
  return {x2 * x2 * x2 * (21 + x * (-60 + x * (67.5 + x * (-35 + x * 7)))), step.value, step.first};
}

/// From rest to full speed over `ramp_s`: time that a body at full speed needs for the same way.
Jet SpeedUp(double since_s, double ramp_s) {
  const Jet ramp = SmoothRamp(since_s / ramp_s);
  return {ramp_s * ramp.value, ramp.first, ramp.second / ramp_s};
}

/// From full speed to rest.
Jet SlowDown(double since_s, double ramp_s) {
  return Jet{since_s, 1, 0} + -1 * SpeedUp(since_s, ramp_s);
}

}  // namespace

Jet MotionTime::Rested(double time_s) const {
  if (config_.rest_s <= 0) {
    return {time_s, 1, 0};
  }
  const double ramp_s = config_.rest_ramp_s;
  const double since_s = time_s - config_.rest_s;
  if (since_s <= 0) {
    return {};
  }
  return since_s >= ramp_s ? Jet{since_s - 0.5 * ramp_s, 1, 0} : SpeedUp(since_s, ramp_s);
}

Jet MotionTime::Paused(const Jet& rested) const {
  if (!HasPauses()) {
    return rested;
  }
  const double ramp_s = config_.rest_ramp_s;
  const double moving_s = MovingSeconds();
  const double period = std::floor(rested.value / config_.pause_period_s);
  const double within_s = rested.value - period * config_.pause_period_s;
  const double paused_s = within_s - moving_s - ramp_s;
  Jet tau{within_s, 1, 0};
  if (paused_s > config_.pause_s) {
    tau = Jet{moving_s + 0.5 * ramp_s, 0, 0} + SpeedUp(paused_s - config_.pause_s, ramp_s);
  } else if (paused_s > 0) {
    tau = {moving_s + 0.5 * ramp_s, 0, 0};
  } else if (within_s > moving_s) {
    tau = Jet{moving_s, 0, 0} + SlowDown(within_s - moving_s, ramp_s);
  }
  return Compose(Jet{period * (moving_s + ramp_s), 0, 0} + tau, rested);
}

Jet MotionTime::PathTime(const Jet& tau) const {
  if (config_.speed_variation == 0) {
    return tau;
  }
  const double rate = 2 * std::numbers::pi / config_.speed_period_s;
  return tau + config_.speed_variation / rate * (Jet{1, 0, 0} + -1 * Cos(rate * tau));
}

Jet MotionTime::PauseTurn(double time_s) const {
  if (!HasPauses()) {
    return {};
  }
  const Jet rested = Rested(time_s);
  const double period = std::floor(rested.value / config_.pause_period_s);
  const double paused_s =
      rested.value - period * config_.pause_period_s - MovingSeconds() - config_.rest_ramp_s;
  Jet turns{period, 0, 0};
  if (paused_s >= config_.pause_s) {
    turns.value += 1;
  } else if (paused_s > 0) {
    const Jet step = SmoothStep(paused_s / config_.pause_s);
    turns = turns +
            Jet{step.value, step.first / config_.pause_s, step.second / (config_.pause_s * config_.pause_s)};
  }
  return config_.pause_turn_rad * Compose(turns, rested);
}

}  // namespace alidade
