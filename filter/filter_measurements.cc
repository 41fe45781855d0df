#include <string>

#include "core/stopwatch.h"
#include "filter/filter_estimator.h"

// Measurements between frames in FilterEstimator.

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
  gnss_.Align(alignment, &state_);
  aligned_ = true;
  return Status::Ok();
}

Status FilterEstimator::BeginMeasurement(const char* what, TimeNs stamp_ns) {
  if (!initialized_ || !aligned_) {
    return Status::Diverged("filter: not aligned");
  }
  if (stamp_ns < state_.stamp_ns()) {
    return Status::Input(std::string("filter: the ") + what + " at " + FormatSeconds(stamp_ns) +
                         " s is older than the state");
  }
  statistics_ = {};
  const Stopwatch stopwatch;
  if (stamp_ns > state_.stamp_ns()) {
    ALIDADE_RETURN_IF_ERROR(PropagateTo(stamp_ns));
  }
  statistics_.propagate_ms = stopwatch.ElapsedMs();
  return Status::Ok();
}

NavEstimate FilterEstimator::EstimateIfWatched() const {
  return config_.calibration.watch ? state_.Estimate() : NavEstimate();
}

Status FilterEstimator::EndMeasurement(const char* what, TimeNs stamp_ns, const NavEstimate& before,
                                       bool finite) {
  if (finite) {
    Correct();
  }
  if (!finite || !state_.AllFinite()) {
    initialized_ = false;
    return Status::Diverged(std::string("filter: state is not finite after the ") + what + " at " +
                            FormatSeconds(stamp_ns) + " s");
  }
  if (config_.calibration.watch) {
    absolute_ = CorrectionBetween(before, state_.Estimate());
  }
  return Status::Ok();
}

Status FilterEstimator::AddGnss(const GnssEpoch& epoch) {
  if (!gnss_.aligned()) {
    return Status::Diverged("filter: not aligned");
  }
  ALIDADE_RETURN_IF_ERROR(BeginMeasurement("GNSS epoch", epoch.stamp_ns));
  const Stopwatch stopwatch;
  const Eigen::Vector3d gyro_radps = TurnAround(imu_.samples(), state_.stamp_ns(), 0).gyro_radps;
  const NavEstimate before = EstimateIfWatched();
  const bool finite = gnss_.Apply(epoch, gyro_radps, &state_, Correction(), &statistics_);
  Status status = EndMeasurement("GNSS epoch", epoch.stamp_ns, before, finite);
  statistics_.update_ms = stopwatch.ElapsedMs();
  return status;
}

Status FilterEstimator::AddMeasurement(const Measurement& measurement) {
  const Result<WhitenedMeasurement> whitened = Whiten(config_, rig_, measurement);
  ALIDADE_RETURN_IF_ERROR(whitened.status());
  const char* const what = NameOf(SensorOf(measurement));
  const TimeNs stamp_ns = StampOf(measurement);
  ALIDADE_RETURN_IF_ERROR(BeginMeasurement(what, stamp_ns));
  const Stopwatch stopwatch;
  const NavEstimate before = EstimateIfWatched();
  const bool finite = measurements_.Apply(*whitened, &state_, Correction(), &statistics_);
  Status status = EndMeasurement(what, stamp_ns, before, finite);
  statistics_.update_ms = stopwatch.ElapsedMs();
  return status;
}

std::optional<ClockState> FilterEstimator::LatestClock() const {
  return gnss_.aligned() ? std::optional(gnss_.Clock(state_)) : std::nullopt;
}

const GnssResiduals* FilterEstimator::last_gnss() const {
  return gnss_.aligned() ? &gnss_.residuals() : nullptr;
}

}  // namespace alidade
