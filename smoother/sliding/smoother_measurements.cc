#include <algorithm>
#include <string>
#include <utility>

#include "core/imu_propagation.h"
#include "core/stopwatch.h"
#include "smoother/manifold/nav_state_manifold.h"
#include "smoother/sliding/smoother_estimator.h"

// Measurements between frames in SmootherEstimator.

namespace alidade {

Status SmootherEstimator::Align(const GnssAlignment& alignment) {
  if (!initialized_) {
    return Status::Diverged("smoother: not initialised");
  }
  // The window begins anew at the newest state in the ENU frame: its information is in that state's
  // covariance.
  ALIDADE_RETURN_IF_ERROR(Begin(TurnIntoEnu(alignment, latest_)));
  aligned_ = true;
  if (alignment.clock) {
    gnss_.Align(alignment, &window_.newest(), &prior_);
    latest_clock_ = FreshClock(config_.gnss, window_.newest().clock_state());
    newest_update_.Begin(latest_, latest_clock_, Eigen::Matrix<double, 6, 15>::Zero());
  }
  if (given_.watched) {
    AddCalibrationPrior(given_,
                        &prior_);  // its correlation with the state is lost
  } else {
    AddCalibrationPrior({calibration_.layout, calibration_.mean, calibration_deviations_}, &prior_);
  }
  return Status::Ok();
}

Result<SmootherEstimator::Attachment> SmootherEstimator::ReachMeasurement(const char* what, TimeNs stamp_ns,
                                                                          double max_interpolation_s) {
  if (!initialized_ || !aligned_) {
    return Status::Diverged("smoother: not aligned");
  }
  const TimeNs newest_ns = window_.newest().stamp_ns;
  if (stamp_ns < newest_ns) {
    return Status::Input(std::string("smoother: the ") + what + " at " + FormatSeconds(stamp_ns) +
                         " s is older than the newest frame");
  }
  statistics_ = {};
  const double after_s = SecondsBetween(newest_ns, stamp_ns);
  Attachment attachment;
  attachment.own_state = after_s > max_interpolation_s || (!has_frames_ && stamp_ns > newest_ns);
  if (attachment.own_state) {
    ALIDADE_RETURN_IF_ERROR(BeginFrame(stamp_ns));
    attachment.imu = {interval_.back()};
  } else if (after_s > 0) {
    ALIDADE_RETURN_IF_ERROR(imu_.Interval(newest_ns, stamp_ns, &attachment.imu));
  } else if (!window_.newest().imu.empty()) {
    attachment.imu = {window_.newest().imu.back()};
  }
  return attachment;
}

bool SmootherEstimator::MayTakeOutNewest() const {
  const WindowFrame& frame = window_.newest();
  const WindowFrame& before = window_.frame(window_.size() - 2);
  if (frame.clock_anew) {
    return false;  // the step of the clock lies between the two
  }
  // The link to a measurement leaves the IMU's noise out, which only a short one allows.
  const auto reaches = [&](TimeNs stamp_ns, double max_interpolation_s) {
    return SecondsBetween(before.stamp_ns, stamp_ns) <= max_interpolation_s;
  };
  return std::all_of(frame.epochs.begin(), frame.epochs.end(),
                     [&](const FrameEpoch& epoch) {
                       return reaches(epoch.stamp_ns, config_.gnss.max_interpolation_s);
                     }) &&
         std::all_of(frame.measurements.begin(), frame.measurements.end(),
                     [&](const FrameMeasurement& attached) {
                       return reaches(attached.imu.empty() ? frame.stamp_ns : attached.imu.back().stamp_ns,
                                      MaxInterpolation(config_, SensorOf(attached.measurement)));
                     });
}

Status SmootherEstimator::SolveWithMeasurement(const Attachment& attachment) {
  if (!attachment.own_state) {
    return Status::Ok();
  }
  std::vector<WindowTrack*> tracks = SelectTracks();
  return SolveAndGate(&tracks);
}

Status SmootherEstimator::AddGnss(const GnssEpoch& epoch) {
  if (!gnss_.aligned()) {
    return Status::Diverged("smoother: not aligned");
  }
  const Stopwatch stopwatch;
  Result<Attachment> attachment =
      ReachMeasurement("GNSS epoch", epoch.stamp_ns, config_.gnss.max_interpolation_s);
  ALIDADE_RETURN_IF_ERROR(attachment.status());
  const bool attached = gnss_.Attach(epoch, std::move(attachment->imu), noise_, &window_.newest());
  statistics_.clock_jump = gnss_.jumped();
  absolute_.reset();
  if (config_.calibration.watch && attached) {
    if (attachment->own_state) {
      ALIDADE_RETURN_IF_ERROR(CarryNewestUpdate());
    }
    const WindowFrame& newest = window_.newest();
    absolute_ = newest_update_.Add(*gnss_.context(), gnss_.gate_threshold(), newest.epochs.back(),
                                   newest.epochs.back().SecondsAfter(newest.stamp_ns));
  }
  ALIDADE_RETURN_IF_ERROR(SolveWithMeasurement(*attachment));
  statistics_.update_ms = stopwatch.ElapsedMs();
  return Status::Ok();
}

Status SmootherEstimator::AddMeasurement(const Measurement& measurement) {
  const Result<WhitenedMeasurement> whitened = Whiten(config_, rig_, measurement);
  ALIDADE_RETURN_IF_ERROR(whitened.status());
  const Stopwatch stopwatch;
  const Sensor sensor = SensorOf(measurement);
  Result<Attachment> attachment =
      ReachMeasurement(NameOf(sensor), StampOf(measurement), MaxInterpolation(config_, sensor));
  ALIDADE_RETURN_IF_ERROR(attachment.status());
  NavEstimate predicted = latest_;
  const std::vector<ImuSample>& since = attachment->own_state ? interval_ : attachment->imu;
  if (since.size() > 1) {
    if (const Status status = PropagateEstimate(since, noise_, gravity_W_, &predicted); !status.ok()) {
      return Lost("smoother: " + status.message());
    }
  }
  const bool attached = measurements_.Attach(*whitened, predicted, std::move(attachment->imu), noise_,
                                             &window_.newest(), &statistics_);
  if (config_.calibration.watch) {
    absolute_ = AbsoluteCorrection{predicted.nav};  // what a refused one does
    if (attachment->own_state) {
      ALIDADE_RETURN_IF_ERROR(CarryNewestUpdate());
    }
    if (attached) {
      absolute_ = newest_update_.Add(window_.newest().measurements.back(), gravity_W_);
    }
  }
  ALIDADE_RETURN_IF_ERROR(SolveWithMeasurement(*attachment));
  statistics_.update_ms = stopwatch.ElapsedMs();
  return Status::Ok();
}

Status SmootherEstimator::CarryNewestUpdate() {
  ClockTransition clock;
  if (window_.newest().clock) {
    clock =
        PropagateClock(config_.gnss, SecondsBetween(interval_.front().stamp_ns, interval_.back().stamp_ns));
  }
  const Status status = newest_update_.Carry(interval_, noise_, gravity_W_, clock);
  return status.ok() ? status : Lost("smoother: " + status.message());
}

std::optional<ClockState> SmootherEstimator::LatestClock() const {
  return gnss_.aligned() ? std::optional(latest_clock_) : std::nullopt;
}

const GnssResiduals* SmootherEstimator::last_gnss() const {
  return gnss_.aligned() ? &gnss_.residuals() : nullptr;
}

}  // namespace alidade
