#include "gnss/model/receiver_clock.h"

namespace alidade {

int ClockBiasIndex(GnssSystem system) {
  switch (system) {
    case GnssSystem::kGalileo:
      return ClockState::kBiases;
    case GnssSystem::kBeidou:
      return ClockState::kBiases + 1;
    case GnssSystem::kQzss:
      return ClockState::kBiases + 2;
    case GnssSystem::kGlonass:
      return ClockState::kBiases + 3;
    default:
      return -1;
  }
}

ClockTransition PropagateClock(const GnssConfig& config, double dt_s) {
  constexpr int c = ClockState::kClock;
  constexpr int d = ClockState::kDrift;
  ClockTransition transition;
  transition.phi(c, d) = dt_s;
  const double phase = config.clock_walk_m_sqrts * config.clock_walk_m_sqrts;
  const double frequency = config.drift_walk_mps_sqrts * config.drift_walk_mps_sqrts;
  transition.q(c, c) = phase * dt_s + frequency * dt_s * dt_s * dt_s / 3;
  transition.q(c, d) = transition.q(d, c) = frequency * dt_s * dt_s / 2;
  transition.q(d, d) = frequency * dt_s;
  const double walk = config.inter_system_walk_m_sqrts * config.inter_system_walk_m_sqrts;
  transition.q.diagonal().tail<4>().setConstant(walk * dt_s);
  return transition;
}

ClockState FreshClock(const GnssConfig& config, const Vector6d& mean) {
  ClockState clock;
  clock.mean = mean;
  clock.covariance(ClockState::kClock, ClockState::kClock) = kFreshClockStdM * kFreshClockStdM;
  clock.covariance(ClockState::kDrift, ClockState::kDrift) = kFreshDriftStdMps * kFreshDriftStdMps;
  for (int i = ClockState::kBiases; i < ClockState::kSize; ++i) {
    const double deviation = mean[i] == 0 ? config.inter_system_std_m : kFreshClockStdM;
    clock.covariance(i, i) = deviation * deviation;
  }
  return clock;
}

}  // namespace alidade
