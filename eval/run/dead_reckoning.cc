#include "eval/run/dead_reckoning.h"

namespace alidade {
namespace {

constexpr size_t kMaxHeld = 2000;  // seconds of samples

}  // namespace

DeadReckoning::DeadReckoning(const ImuNoise& noise, double gravity_mps2, double max_gap_s)
    : noise_(noise), gravity_W_(GravityInWorld(gravity_mps2)), imu_(max_gap_s) {}

void DeadReckoning::Reset(const NavEstimate& estimate) {
  start_ = estimate;
  stamp_ns_ = estimate.stamp_ns;
  nav_ = estimate.nav;
  transition_ = ImuTransition();
  imu_.DropBefore(stamp_ns_);
}

void DeadReckoning::AddImu(const ImuSample& sample) {
  static_cast<void>(imu_.Add(sample).ok());  // a refused sample lies before the start
  if (imu_.samples().size() > kMaxHeld) {
    Advance(imu_.samples()[kMaxHeld / 2].stamp_ns);
  }
}

void DeadReckoning::Advance(TimeNs stamp_ns) {
  if (stamp_ns > stamp_ns_ && imu_.Interval(stamp_ns_, stamp_ns, &interval_).ok()) {
    PropagateImu(interval_, start_.bias, noise_, gravity_W_, &nav_, &transition_);
    stamp_ns_ = stamp_ns;
    imu_.DropBefore(stamp_ns_);
  }
}

std::optional<NavEstimate> DeadReckoning::At(TimeNs stamp_ns) {
  if (stamp_ns == stamp_ns_) {
    return Here();
  }
  if (!imu_.Interval(stamp_ns_, stamp_ns, &interval_).ok()) {
    return std::nullopt;
  }
  NavState nav = nav_;
  ImuTransition transition = transition_;
  PropagateImu(interval_, start_.bias, noise_, gravity_W_, &nav, &transition);
  return Carried(stamp_ns, nav, transition);
}

NavEstimate DeadReckoning::Carried(TimeNs stamp_ns, const NavState& nav,
                                   const ImuTransition& transition) const {
  NavEstimate estimate = start_;
  estimate.stamp_ns = stamp_ns;
  estimate.nav = nav;
  estimate.covariance = transition.phi * start_.covariance * transition.phi.transpose() + transition.q;
  return estimate;
}

}  // namespace alidade
