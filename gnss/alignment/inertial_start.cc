#include "gnss/alignment/inertial_start.h"

#include <algorithm>
#include <cmath>

#include "core/dense_solvers.h"
#include "core/error_convention.h"
#include "core/format.h"
#include "core/imu_buffer.h"
#include "core/imu_propagation.h"
#include "core/lever_arm.h"
#include "core/robust.h"
#include "gnss/alignment/antenna_at_epoch.h"
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
constexpr int kIntegrations = 2;
constexpr int kStepsPerIntegration = 5;

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

/// The rotation that turns the vectors `from` into `to` best (Kabsch).
Matrix3d RotationBetween(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to) {
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    sum += to[i] * from[i].transpose();
  }
  return so3::Normalize(sum);
}

}  // namespace

/// State at the first epoch.
struct GnssInertialStart::Fit {
  bool ok = false;
  double cost = INFINITY;
  TimeNs first_ns = 0;  ///< IMU time of the first epoch
  NavState nav;
  ImuBias bias;
  Matrix15d covariance = Matrix15d::Zero();
  std::vector<Preintegration> intervals;  ///< from the first epoch to each later one
  std::vector<Vector3d> gyro_radps;       ///< as measured at each epoch, the first included
};

/// Normal equations over the error of the state at the first epoch, canonical chart.
struct GnssInertialStart::Equations {
  Matrix15d hessian = Matrix15d::Zero();
  Vector15d gradient = Vector15d::Zero();
  double cost = 0;  ///< robust

  /// `jacobian`: of the residual over the state at its epoch; `chain`: of that state over the first.
  void Add(const Vector3d& residual, const Eigen::Matrix<double, 3, 15>& jacobian, const Matrix15d& chain,
           const Matrix3d& root, const ObservationKernel& kernel) {
    const Vector3d r = root * residual;
    const double weight = kernel.Weight(r.squaredNorm());
    const Eigen::Matrix<double, 3, 15> j = root * jacobian * chain;
    hessian += weight * j.transpose() * j;
    gradient += weight * j.transpose() * r;
    cost += weight * r.squaredNorm();
  }
  /// Zero-mean prior of the three unknowns from `column` on.
  void AddPrior(Eigen::Index column, const Vector3d& value, double deviation) {
    const double information = 1 / (deviation * deviation);
    hessian.diagonal().segment<3>(column).array() += information;
    gradient.segment<3>(column) += information * value;
  }
};

GnssInertialStart::GnssInertialStart(const EstimatorConfig& config, const RigCalibration& rig)
    : config_(config.gnss),
      init_(config.init),
      receiver_(rig.gnss),
      noise_(config.imu.Scaled(rig.imu_noise)),
      gravity_W_(GravityInWorld(config.imu.gravity_mps2)) {}

void GnssInertialStart::AddImu(const ImuSample& sample) {
  if (imu_.empty() || sample.stamp_ns > imu_.back().stamp_ns) {
    imu_.push_back(sample);
  }
}

void GnssInertialStart::AddEpoch(const GnssEpoch& epoch, const std::optional<SinglePointSolution>& solution) {
  left_out_.Add(epoch.measurements.left_out);
  ForgetOld(epoch.stamp_ns);
  if (!solution || !solution->has_velocity ||
      (!fixes_.empty() && SecondsBetween(fixes_.back().stamp_ns, epoch.stamp_ns) < kMinSpacingS)) {
    return;
  }
  if (!enu_) {
    enu_ = EnuFrame::At(receiver_.anchor_E.value_or(solution->position_E));
  }
  Fix fix;
  fix.stamp_ns = epoch.stamp_ns;
  fix.position_E = solution->position_E;
  fix.velocity_E = solution->velocity_E;
  fix.position_root = InformationRoot(solution->position_covariance_E, kPositionFloorM);
  fix.velocity_root = InformationRoot(solution->velocity_covariance_E, kVelocityFloorMps);
  fix.clock = ClockOfGps(*solution);
  fixes_.push_back(fix);
}

void GnssInertialStart::ForgetOld(TimeNs newest_ns) {
  const TimeNs oldest = newest_ns - SecondsToNs(config_.align_window_s);
  while (!fixes_.empty() && fixes_.front().stamp_ns < oldest) {
    fixes_.pop_front();
  }
  const TimeNs first = fixes_.empty() ? newest_ns : fixes_.front().stamp_ns;
  const TimeNs needed = first - SecondsToNs(config_.max_time_offset_s) - kSecondNs;
  while (imu_.size() > 2 && imu_[1].stamp_ns < needed) {
    imu_.pop_front();
  }
}

void GnssInertialStart::ForgetUnreached() {
  const TimeNs reach = SecondsToNs(config_.estimate_time_offset ? config_.max_time_offset_s : 0);
  while (!fixes_.empty() && (imu_.empty() || fixes_.front().stamp_ns - reach < imu_.front().stamp_ns)) {
    fixes_.pop_front();
  }
}

bool GnssInertialStart::Integrate(double offset_s, Fit* fit) const {
  constexpr double kAnyGapS = 1e6;
  ImuBuffer buffer(kAnyGapS);
  for (const ImuSample& sample : imu_) {
    (void)buffer.Add(sample);
  }
  Preintegration sum(fit->bias, noise_);
  fit->intervals.clear();
  fit->gyro_radps.clear();
  fit->first_ns = fixes_.front().stamp_ns + SecondsToNs(offset_s);
  TimeNs from = fit->first_ns;
  std::vector<ImuSample> samples;
  for (std::size_t k = 1; k < fixes_.size(); ++k) {
    const TimeNs to = fixes_[k].stamp_ns + SecondsToNs(offset_s);
    if (!buffer.Interval(from, to, &samples).ok()) {
      return false;
    }
    sum.Add(samples);
    fit->intervals.push_back(sum);
    if (k == 1) {
      fit->gyro_radps.push_back(samples.front().gyro);
    }
    fit->gyro_radps.push_back(samples.back().gyro);
    from = to;
  }
  return !fit->intervals.empty();
}

/// Attitude by velocity matching; velocity and position of the first epoch.
NavState GnssInertialStart::FirstGuess(const Fit& fit) const {
  const Matrix3d R_NE = enu_->R_EN.transpose();
  const Fix& first = fixes_.front();
  std::vector<Vector3d> sensed;
  std::vector<Vector3d> seen;
  for (std::size_t k = 0; k < fit.intervals.size(); ++k) {
    sensed.push_back(fit.intervals[k].motion().beta);
    seen.push_back(R_NE * (fixes_[k + 1].velocity_E - first.velocity_E) -
                   fit.intervals[k].duration_s() * gravity_W_);
  }
  NavState nav;
  nav.R_WB = RotationBetween(sensed, seen);
  nav.v_WB = R_NE * first.velocity_E;
  nav.p_WB = enu_->FromEcef(first.position_E) - LeverArm{receiver_.p_BA}.Position(nav);
  return nav;
}

GnssInertialStart::Equations GnssInertialStart::Linearize(const Fit& fit) const {
  const AntennaMount mount{*enu_, receiver_.p_BA};
  const ObservationKernel kernel{config_.robust_kernel, config_.robust_scale_sigma};
  Equations equations;
  for (std::size_t k = 0; k < fixes_.size(); ++k) {
    const AntennaAtEpoch at = PredictAntenna(mount, k > 0 ? &fit.intervals[k - 1] : nullptr, gravity_W_,
                                             fit.nav, fit.bias, fit.gyro_radps[k]);
    equations.Add(at.position_E - fixes_[k].position_E, at.position_jacobian, at.chain,
                  fixes_[k].position_root, kernel);
    equations.Add(at.velocity_E - fixes_[k].velocity_E, at.velocity_jacobian, at.chain,
                  fixes_[k].velocity_root, kernel);
  }
  equations.AddPrior(9, fit.bias.gyro, init_.gyro_bias_std_radps);
  equations.AddPrior(12, fit.bias.accel, init_.accel_bias_std_mps2);
  return equations;
}

GnssInertialStart::Fit GnssInertialStart::Solve(double offset_s) const {
  Fit fit;
  for (int iteration = 0; iteration < kIntegrations * kStepsPerIntegration; ++iteration) {
    // Over tens of seconds a bias of 5 mrad/s is beyond the increments' first order.
    if (iteration % kStepsPerIntegration == 0 && !Integrate(offset_s, &fit)) {
      return fit;
    }
    if (iteration == 0) {
      fit.nav = FirstGuess(fit);
    }
    const Equations equations = Linearize(fit);
    const SymmetricSolver solver(equations.hessian);
    const Vector15d step = solver.Solve(-equations.gradient);
    if (!solver.positive() || !step.allFinite()) {
      return fit;
    }
    fit.nav = Retract(ErrorConvention::kSo3xRn, fit.nav, step.head<9>());
    fit.nav.R_WB = so3::Normalize(fit.nav.R_WB);
    fit.bias.gyro += step.segment<3>(9);
    fit.bias.accel += step.segment<3>(12);
    fit.cost = equations.cost;
    fit.covariance = solver.Solve(Matrix15d::Identity());
  }
  fit.ok = true;
  return fit;
}

std::optional<GnssInertialStart::Start> GnssInertialStart::TryStart() {
  ForgetUnreached();
  if (static_cast<int>(fixes_.size()) < config_.align_min_epochs) {
    report_ =
        Format("%zu single points with velocity, expected %d", fixes_.size(), config_.align_min_epochs) +
        (fixes_.empty() ? "; satellites left out: " + Describe(left_out_) : "");
    return std::nullopt;
  }
  Fit best = Solve(0);
  const auto yaw_std = [&](const Fit& fit) {
    const Matrix3d attitude = fit.nav.R_WB * fit.covariance.topLeftCorner<3, 3>() * fit.nav.R_WB.transpose();
    return config_.align_inflation * std::sqrt(attitude(2, 2));
  };
  if (!best.ok || !(yaw_std(best) < config_.align_max_yaw_std_rad)) {
    report_ = best.ok ? Format("heading to %.2f rad, expected below %.2f: too little motion", yaw_std(best),
                               config_.align_max_yaw_std_rad)
                      : "the single points do not determine a start";
    return std::nullopt;
  }
  double offset_s = 0;
  if (config_.estimate_time_offset) {
    constexpr int kSteps = 20;
    for (int i = -kSteps; i <= kSteps; ++i) {
      const double candidate = config_.max_time_offset_s * i / kSteps;
      Fit fit = Solve(candidate);
      if (fit.ok && fit.cost < best.cost) {
        best = std::move(fit);
        offset_s = candidate;
      }
    }
  }
  Matrix15d chain;
  const Preintegration& whole = best.intervals.back();
  Start start;
  start.estimate.nav = CarryState(whole, best.nav, best.bias, gravity_W_, &chain);
  start.estimate.bias = best.bias;
  start.estimate.stamp_ns = fixes_.back().stamp_ns + SecondsToNs(offset_s);
  const Matrix15d covariance =
      config_.align_inflation * config_.align_inflation * chain * best.covariance * chain.transpose();
  start.estimate.covariance = 0.5 * (covariance + covariance.transpose());
  start.alignment.stamp_ns = start.estimate.stamp_ns;
  start.alignment.enu = *enu_;
  constexpr double kNothing = 1e-12;  // the uncertainty is in the state
  start.alignment.covariance = kNothing * Eigen::Matrix4d::Identity();
  start.alignment.clock = fixes_.back().clock;
  start.alignment.time_offset_s = offset_s;
  report_ = Format("%zu single points over %.1f s: heading to %.3f rad", fixes_.size(),
                   SecondsBetween(fixes_.front().stamp_ns, fixes_.back().stamp_ns), yaw_std(best)) +
            (config_.estimate_time_offset ? Format(", time offset %.3f s", offset_s) : "");
  start.alignment.report = report_;
  return start;
}

}  // namespace alidade
