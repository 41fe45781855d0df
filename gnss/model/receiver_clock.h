#pragma once

#include "core/clock_state.h"
#include "core/gnss_config.h"
#include "gnss/base/satellite_id.h"

namespace alidade {

/// Where the bias of a system stands in a ClockState; -1 for the datum, GPS (and systems that are not used).
[[nodiscard]] int ClockBiasIndex(GnssSystem system);

/// Clock over an interval: c' = phi c + w, w ~ N(0, q).
struct ClockTransition {
  Matrix6d phi = Matrix6d::Identity();
  Matrix6d q = Matrix6d::Zero();
};

/// The two-state clock: d clock = drift dt + w_1, d drift = w_2 (white frequency noise and frequency walk;
/// Brown and Hwang, "Introduction to Random Signals", 9.3); biases between systems walk on their own. dt_s >=
/// 0.
[[nodiscard]] ClockTransition PropagateClock(const GnssConfig& config, double dt_s);

/// A clock that was just found: clock and drift with the deviations below, a bias with the clock's where it
/// is known (not zero), else with inter_system_std_m. Wider, the gate would let reflections into the first
/// update.
[[nodiscard]] ClockState FreshClock(const GnssConfig& config, const Vector6d& mean);

inline constexpr double kFreshClockStdM = 3;
inline constexpr double kFreshDriftStdMps = 1;

}  // namespace alidade
