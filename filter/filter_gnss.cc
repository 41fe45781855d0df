#include "core/stopwatch.h"
#include "filter/filter_estimator.h"

// GNSS of FilterEstimator.

namespace alidade {

Status FilterEstimator::Align(const GnssAlignment& alignment) {
  if (!initialized_) {
    return Status::Diverged("filter: not initialised");
  }
  // What is remembered of landmarks stands in the local world: it begins anew, once in a run.
  while (!state_.landmarks().empty()) {
    state_.RemoveLandmark(state_.landmarks().size() - 1);
  }
  for (Track& track : tracks_.tracks()) {
    if (track.in_state) {
      track.in_state = false;
      track.views.clear();
    }
    track.memory.active = false;
  }
  rest_.Clear();
  gnss_.Align(alignment, &state_);
  return Status::Ok();
}

Status FilterEstimator::AddGnss(const GnssEpoch& epoch) {
  if (!initialized_ || !gnss_.aligned()) {
    return Status::Diverged("filter: not aligned");
  }
  if (epoch.stamp_ns < state_.stamp_ns()) {
    return Status::Input("filter: the GNSS epoch at " + FormatSeconds(epoch.stamp_ns) +
                         " s is older than the state");
  }
  statistics_ = {};
  const Stopwatch stopwatch;
  if (epoch.stamp_ns > state_.stamp_ns()) {
    ALIDADE_RETURN_IF_ERROR(PropagateTo(epoch.stamp_ns));
  }
  statistics_.propagate_ms = stopwatch.ElapsedMs();
  const bool finite = gnss_.Apply(epoch, last_gyro_radps_, &state_, Correction(), &statistics_);
  if (finite) {
    Correct();
  }
  statistics_.update_ms = stopwatch.ElapsedMs() - statistics_.propagate_ms;
  if (!finite || !state_.AllFinite()) {
    initialized_ = false;
    return Status::Diverged("filter: state is not finite after the GNSS epoch at " +
                            FormatSeconds(epoch.stamp_ns) + " s");
  }
  return Status::Ok();
}

std::optional<ClockState> FilterEstimator::LatestClock() const {
  return gnss_.aligned() ? std::optional(gnss_.Clock(state_)) : std::nullopt;
}

const GnssResiduals* FilterEstimator::last_gnss() const {
  return gnss_.aligned() ? &gnss_.residuals() : nullptr;
}

}  // namespace alidade
