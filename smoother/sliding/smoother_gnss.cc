#include "core/stopwatch.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/sliding/smoother_estimator.h"

// GNSS of SmootherEstimator.

namespace alidade {

Status SmootherEstimator::Align(const GnssAlignment& alignment) {
  if (!initialized_) {
    return Status::Diverged("smoother: not initialised");
  }
  // The window begins anew at the newest state in the ENU frame: what it knew is in that state's covariance.
  ALIDADE_RETURN_IF_ERROR(Begin(TurnIntoEnu(alignment, latest_)));
  gnss_.Align(alignment, &window_.newest(), &prior_);
  AddCalibrationPrior({calibration_.layout, calibration_.mean, calibration_deviations_}, &prior_);
  latest_clock_ = FreshClock(config_.gnss, window_.newest().clock_state());
  return Status::Ok();
}

Status SmootherEstimator::AddGnss(const GnssEpoch& epoch) {
  if (!initialized_ || !gnss_.aligned()) {
    return Status::Diverged("smoother: not aligned");
  }
  const TimeNs newest_ns = window_.newest().stamp_ns;
  if (epoch.stamp_ns < newest_ns) {
    return Status::Input("smoother: the GNSS epoch at " + FormatSeconds(epoch.stamp_ns) +
                         " s is older than the newest frame");
  }
  const Stopwatch stopwatch;
  statistics_ = {};
  const double after_s = SecondsBetween(newest_ns, epoch.stamp_ns);
  const bool own_state =
      after_s > config_.gnss.max_interpolation_s || (!has_frames_ && epoch.stamp_ns > newest_ns);
  std::vector<ImuSample> imu;
  if (own_state) {
    ALIDADE_RETURN_IF_ERROR(BeginFrame(epoch.stamp_ns));
    imu = {interval_.back()};
  } else if (after_s > 0) {
    ALIDADE_RETURN_IF_ERROR(imu_.Interval(newest_ns, epoch.stamp_ns, &imu));
  } else if (!window_.newest().imu.empty()) {
    imu = {window_.newest().imu.back()};
  }
  gnss_.Attach(epoch, std::move(imu), noise_, &window_.newest());
  statistics_.clock_jump = gnss_.jumped();
  if (own_state) {
    std::vector<WindowTrack*> tracks = SelectTracks();
    ALIDADE_RETURN_IF_ERROR(SolveAndGate(&tracks));
  }
  statistics_.update_ms = stopwatch.ElapsedMs();
  return Status::Ok();
}

std::optional<ClockState> SmootherEstimator::LatestClock() const {
  return gnss_.aligned() ? std::optional(latest_clock_) : std::nullopt;
}

const GnssResiduals* SmootherEstimator::last_gnss() const {
  return gnss_.aligned() ? &gnss_.residuals() : nullptr;
}

}  // namespace alidade
