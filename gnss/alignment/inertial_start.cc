#include "gnss/alignment/inertial_start.h"

#include <cmath>
#include <utility>

#include "core/dense_solvers.h"
#include "core/format.h"
#include "gnss/model/measurement_model.h"
#include "gnss/model/receiver_clock.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Errors of single points are correlated in time: a start is known no better than this.
constexpr double kPositionFloorM = 3;
constexpr double kVelocityFloorMps = 0.15;  // lever arm, scale and quantisation of the IMU too
constexpr double kMinSpacingS = 0.4;        // between the epochs that are used

Matrix3d InformationRoot(const Matrix3d& covariance, double floor) {
  const Matrix3d widened = covariance + floor * floor * Matrix3d::Identity();
  return Whitener(widened);
}

/// The solution's clock as a ClockState's mean, which refers to GPS whatever the solution's datum is. The
/// clock of a GPS that was not seen is taken to be the datum's.
Vector6d ClockOfGps(const SinglePointSolution& solution) {
  const auto bias = [&](GnssSystem system) {
    return solution.inter_system_bias_m[SystemIndex(system)].value_or(0);
  };
  const double gps = bias(GnssSystem::kGps);
  Vector6d clock = Vector6d::Zero();
  clock[ClockState::kClock] = solution.clock_m + gps;
  clock[ClockState::kDrift] = solution.drift_mps;
  for (int i = 0; i < kGnssSystems; ++i) {
    const auto system = static_cast<GnssSystem>(i);
    if (const int index = ClockBiasIndex(system); index >= 0) {
      clock[index] = bias(system) - gps;
    }
  }
  return clock;
}

}  // namespace

GnssInertialStart::GnssInertialStart(const EstimatorConfig& config, const RigCalibration& rig)
    : config_(config.gnss), receiver_(rig.gnss), fitter_(config, rig) {}

void GnssInertialStart::AddImu(const ImuSample& sample) {
  if (window_.imu.empty() || sample.stamp_ns > window_.imu.back().stamp_ns) {
    window_.imu.push_back(sample);
  }
}

void GnssInertialStart::AddEpoch(const GnssEpoch& epoch, const std::optional<SinglePointSolution>& solution) {
  left_out_.Add(epoch.measurements.left_out);
  ForgetOld(epoch.stamp_ns);
  if (!solution || !solution->has_velocity ||
      (!window_.points.empty() &&
       SecondsBetween(window_.points.back().stamp_ns, epoch.stamp_ns) < kMinSpacingS)) {
    return;
  }
  if (!window_.enu) {
    window_.enu = EnuFrame::At(receiver_.anchor_E.value_or(solution->position_E));
  }
  InertialPoint point;
  point.stamp_ns = epoch.stamp_ns;
  point.position_E = solution->position_E;
  point.velocity_E = solution->velocity_E;
  point.position_root = InformationRoot(solution->position_covariance_E, kPositionFloorM);
  point.velocity_root = InformationRoot(solution->velocity_covariance_E, kVelocityFloorMps);
  point.clock = ClockOfGps(*solution);
  window_.points.push_back(point);
}

void GnssInertialStart::ForgetOld(TimeNs newest_ns) {
  const TimeNs oldest = newest_ns - SecondsToNs(config_.align_window_s);
  while (!window_.points.empty() && window_.points.front().stamp_ns < oldest) {
    window_.points.pop_front();
  }
  const TimeNs first = window_.points.empty() ? newest_ns : window_.points.front().stamp_ns;
  const TimeNs needed = first - SecondsToNs(config_.max_time_offset_s) - kSecondNs;
  while (window_.imu.size() > 2 && window_.imu[1].stamp_ns < needed) {
    window_.imu.pop_front();
  }
}

void GnssInertialStart::ForgetUnreached() {
  const TimeNs reach = SecondsToNs(config_.estimate_time_offset ? config_.max_time_offset_s : 0);
  while (!window_.points.empty() &&
         (window_.imu.empty() || window_.points.front().stamp_ns - reach < window_.imu.front().stamp_ns)) {
    window_.points.pop_front();
  }
}

std::optional<GnssInertialStart::Start> GnssInertialStart::TryStart() {
  ForgetUnreached();
  if (static_cast<int>(window_.points.size()) < config_.align_min_epochs) {
    report_ = Format("%zu single points with velocity, expected %d", window_.points.size(),
                     config_.align_min_epochs) +
              (window_.points.empty() ? "; satellites left out: " + Describe(left_out_) : "");
    return std::nullopt;
  }
  InertialFit best = fitter_.Solve(window_, 0);
  if (!best.ok || !(YawStd(best) < config_.align_max_yaw_std_rad)) {
    report_ = best.ok ? Format("heading to %.2f rad, expected below %.2f: too little motion", YawStd(best),
                               config_.align_max_yaw_std_rad)
                      : "the single points do not determine a start";
    return std::nullopt;
  }
  const double offset_s = config_.estimate_time_offset ? SearchOffset(&best) : 0;
  report_ =
      Format("%zu single points over %.1f s: heading to %.3f rad", window_.points.size(),
             SecondsBetween(window_.points.front().stamp_ns, window_.points.back().stamp_ns), YawStd(best)) +
      (config_.estimate_time_offset ? Format(", time offset %.3f s", offset_s) : "");
  return MakeStart(best, offset_s);
}

double GnssInertialStart::YawStd(const InertialFit& fit) const {
  const Matrix3d attitude = fit.nav.R_WB * fit.covariance.topLeftCorner<3, 3>() * fit.nav.R_WB.transpose();
  return config_.align_inflation * std::sqrt(attitude(2, 2));
}

double GnssInertialStart::SearchOffset(InertialFit* best) const {
  constexpr int kSteps = 20;
  double offset_s = 0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double candidate = config_.max_time_offset_s * i / kSteps;
    InertialFit fit = fitter_.Solve(window_, candidate);
    if (fit.ok && fit.cost < best->cost) {
      *best = std::move(fit);
      offset_s = candidate;
    }
  }
  return offset_s;
}

GnssInertialStart::Start GnssInertialStart::MakeStart(const InertialFit& fit, double offset_s) const {
  Matrix15d chain;
  Start start;
  start.estimate.nav = fitter_.LastState(fit, &chain);
  start.estimate.bias = fit.bias;
  start.estimate.stamp_ns = window_.points.back().stamp_ns + SecondsToNs(offset_s);
  const Matrix15d covariance =
      config_.align_inflation * config_.align_inflation * chain * fit.covariance * chain.transpose();
  start.estimate.covariance = 0.5 * (covariance + covariance.transpose());
  start.alignment.stamp_ns = start.estimate.stamp_ns;
  start.alignment.enu = *window_.enu;
  constexpr double kNothing = 1e-12;  // the uncertainty is in the state
  start.alignment.covariance = kNothing * Eigen::Matrix4d::Identity();
  start.alignment.clock = window_.points.back().clock;
  start.alignment.time_offset_s = offset_s;
  start.alignment.report = report_;
  return start;
}

}  // namespace alidade
