#include "eval/simulation/sim_signal_path.h"

#include <cmath>

#include "gnss/base/constants.h"

namespace alidade {

SimReceiverClock::SimReceiverClock(const SimGnssConfig& config, std::uint64_t seed)
    : config_(config), stream_(seed, "gnss.clock") {
  bias_m_ = config.clock_bias_m * stream_.Normal();
  drift_mps_ = config.clock_drift_mps * stream_.Normal();
}

void SimReceiverClock::Advance(double dt_s, double time_s) {
  constexpr double kMillisecondM = 1e-3 * kSpeedOfLight;
  bias_m_ += drift_mps_ * dt_s + config_.clock_walk_m_sqrts * std::sqrt(dt_s) * stream_.Normal();
  drift_mps_ += config_.drift_walk_mps_sqrts * std::sqrt(dt_s) * stream_.Normal();
  if (!jumped_ && config_.clock_jump_at_s >= 0 && time_s >= config_.clock_jump_at_s) {
    bias_m_ += kMillisecondM;
    jumped_ = true;
  }
}

SimSignalPath::SimSignalPath(const SimGnssConfig& config, std::uint64_t seed, const std::string& name)
    : config_(config),
      noise_(seed, "gnss.noise." + name),
      multipath_(seed, "gnss.multipath." + name),
      nlos_(seed, "gnss.nlos." + name) {
  multipath_m_ = config.multipath_m * multipath_.Normal();
  DrawReflection();
}

void SimSignalPath::Advance(double dt_s) {
  const double keep = std::exp(-dt_s / config_.multipath_time_s);
  multipath_m_ = keep * multipath_m_ + config_.multipath_m * std::sqrt(1 - keep * keep) * multipath_.Normal();
  if (nlos_.Chance(1 - std::exp(-dt_s / config_.nlos_time_s))) {
    DrawReflection();
  }
}

void SimSignalPath::DrawReflection() {
  const bool reflected = nlos_.Chance(config_.nlos_rate);
  const double extra = nlos_.Uniform(config_.nlos_min_m, config_.nlos_max_m);
  reflection_m_ = reflected ? extra : 0;
}

}  // namespace alidade
