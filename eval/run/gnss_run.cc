#include "eval/run/gnss_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"

namespace alidade {
namespace {

/// Variance of the whitened residuals of a solution over what its covariance holds, at most one. Orbits,
/// clocks and atmosphere dominate what is stated, but hardly change within a minute, and mostly they are
/// better.
double ScatterShare(const SinglePointSolution& solution) {
  constexpr int kLeastFreedom = 8;  // fewer residuals do not decide
  constexpr double kLeast = 0.04;
  double squares = 0;
  for (const SatelliteResidual& satellite : solution.satellites) {
    const double whitened = satellite.residual_m / satellite.deviation_m;
    squares += satellite.used ? whitened * whitened : 0;
  }
  const int freedom = solution.used - 3 - kGnssSystems;
  return freedom < kLeastFreedom
             ? 1
             : std::clamp(squares / freedom / (solution.scale * solution.scale), kLeast, 1.0);
}

}  // namespace

GnssRun::GnssRun(const EstimatorConfig& config, const RigCalibration& rig, const GnssSetup& setup,
                 double lateness_s, Estimator* estimator, std::vector<SessionEvent>* events)
    : SensorRun(Sensor::kGnss, lateness_s, events),
      receiver_(rig.gnss),
      estimator_(*estimator),
      feed_(config.gnss, setup, rig.gnss.time_offset_s),
      aligner_(config.gnss, rig.gnss),
      start_(config, rig) {}

bool GnssRun::Add(std::shared_ptr<const ObservationEpoch> epoch, TimeNs processed_ns) {
  const TimeNs tag_ns = epoch->stamp_ns;
  const TimeNs expected_ns = feed_.ExpectedStamp(tag_ns).value_or(INT64_MAX);
  if (expected_ns < processed_ns) {
    RefuseLate(tag_ns, processed_ns - expected_ns);
    return false;
  }
  switch (feed_.Add(std::move(epoch))) {
    case GnssFeed::Arrival::kTwice:
      Skip(tag_ns, "there is one with this tag already");
      return false;
    case GnssFeed::Arrival::kTooLate:
      RefuseLate(tag_ns, feed_.last_tag_ns() - tag_ns);
      return false;
    case GnssFeed::Arrival::kTaken:
      break;
  }
  return true;
}

std::optional<TimeNs> GnssRun::NextImuTime() {
  const GnssEpoch* epoch = feed_.Next();
  return epoch != nullptr ? std::optional(epoch->stamp_ns) : std::nullopt;
}

void GnssRun::SkipNext() {
  const TimeNs tag_ns = feed_.Next()->measurements.tag_ns;
  feed_.Pop();
  Skip(tag_ns, Format("the IMU does not reach it, and %zu epochs wait", feed_.size()));
}

Result<bool> GnssRun::Take(bool running) {
  const GnssEpoch& epoch = *feed_.Next();
  const TimeNs tag_ns = epoch.measurements.tag_ns;
  Status status;
  if (!aligned()) {
    aligner_.AddEpoch(epoch, feed_.approximate_E(), feed_.solution());
  } else if (running) {
    status = estimator_.AddGnss(epoch);
  }
  const bool taken = aligned() && running && status.ok();
  SetComparison(taken ? Compare(epoch.stamp_ns) : std::nullopt);
  feed_.Pop();
  if (aligned() && !running) {
    Skip(tag_ns, "the estimate is lost");
  } else if (status.code() == StatusCode::kInput) {
    Skip(tag_ns, status.message());
  } else if (!status.ok()) {
    return status;
  }
  if (taken) {
    CollectResiduals();
  }
  return taken;
}

std::optional<AbsoluteComparison> GnssRun::Compare(TimeNs stamp_ns) const {
  const AbsoluteCorrection* correction = estimator_.last_correction();
  const std::optional<SinglePointSolution>& solution = feed_.solution();
  if (correction == nullptr || !solution) {
    return std::nullopt;
  }
  const AntennaMount mount{enu(), receiver_.p_BA};
  const Eigen::Matrix3d R_NE = enu().R_EN.transpose();
  const Eigen::Vector3d left_E = solution->position_E - mount.Position(correction->nav, nullptr);
  return AbsoluteComparison{
      stamp_ns,
      0,
      correction->change,
      correction->covariance,
      R_NE * left_E,
      ScatterShare(*solution) * R_NE * solution->position_covariance_E * R_NE.transpose()};
}

void GnssRun::CollectResiduals() {
  const GnssResiduals* residuals = estimator_.last_gnss();
  if (residuals != nullptr && !residuals->satellites.empty() && residuals_ns_ < residuals->stamp_ns) {
    residuals_ns_ = residuals->stamp_ns;
    events().emplace_back(SatellitesEvent{*residuals});
  }
}

void GnssRun::Remember(TimeNs stamp_ns, const std::optional<ClockState>& clock) {
  if (clock) {
    clock_ = clock->mean;
    clock_ns_ = stamp_ns;
  }
}

Result<std::optional<GnssAlignment>> GnssRun::Align(TimeNs stamp_ns, const Eigen::Vector3d& gyro_radps) {
  if (aligned()) {
    return std::optional<GnssAlignment>();
  }
  const NavEstimate latest = estimator_.Latest();
  if (latest.stamp_ns != stamp_ns) {
    return std::optional<GnssAlignment>();  // the frame was refused
  }
  aligner_.AddState(stamp_ns, latest.nav, latest.bias, gyro_radps, latest.covariance.block<3, 3>(6, 6));
  const std::optional<GnssAlignment> alignment = aligner_.TryAlign();
  if (!alignment) {
    ReportWaiting(stamp_ns);
    return alignment;
  }
  ALIDADE_RETURN_IF_ERROR(estimator_.Align(*alignment));
  ReportAligned(*alignment, stamp_ns, std::sqrt(alignment->covariance(0, 0)));
  return alignment;
}

void GnssRun::ReportWaiting(TimeNs stamp_ns) {
  if (aligner_.report() != waiting_for_) {
    waiting_for_ = aligner_.report();
    events().emplace_back(WaitingEvent{Sought::kAlignment, stamp_ns, waiting_for_});
  }
}

void GnssRun::ReportAligned(const GnssAlignment& alignment, TimeNs stamp_ns, double yaw_std_rad) {
  alignment_ = alignment;
  feed_.ShiftTime(alignment.time_offset_s);
  AlignedEvent event;
  event.global = {alignment.enu,         Sensor::kGnss,     receiver_.p_BA, stamp_ns,
                  feed_.time_offset_s(), alignment.yaw_rad, yaw_std_rad};
  event.alignment = alignment;
  event.estimate = estimator_.Latest();
  event.clock = estimator_.LatestClock();
  Remember(event.estimate.stamp_ns, event.clock);
  events().emplace_back(std::move(event));
}

Status GnssRun::Realign() {
  if (!alignment_) {
    aligner_.ForgetEstimate();
    return Status::Ok();
  }
  GnssAlignment identity = AlreadyAligned(*alignment_, clock_ns_);
  identity.clock = clock_;
  return estimator_.Align(identity);
}

std::optional<GnssInertialStart::Start> GnssRun::TryStart() {
  start_.AddEpoch(*feed_.Next(), feed_.solution());
  feed_.Pop();
  return start_.TryStart();
}

Status GnssRun::AlignAtStart(const GnssInertialStart::Start& start) {
  ALIDADE_RETURN_IF_ERROR(estimator_.Align(start.alignment));
  const Eigen::Matrix3d& R_WB = start.estimate.nav.R_WB;
  const Eigen::Matrix3d attitude = R_WB * start.estimate.covariance.topLeftCorner<3, 3>() * R_WB.transpose();
  ReportAligned(start.alignment, start.estimate.stamp_ns, std::sqrt(attitude(2, 2)));
  return Status::Ok();
}

}  // namespace alidade
