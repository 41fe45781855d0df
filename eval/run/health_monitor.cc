#include "eval/run/health_monitor.h"

#include "core/estimator/estimator.h"
#include "core/format.h"
#include "core/yaw_shift.h"

namespace alidade {
namespace {

using Eigen::Vector3d;

constexpr double kSlipMps = 1.0;        // by which a sound reckoning may slip besides the speed itself
constexpr double kUnknownYawRad = 1.0;  // deviation of a yaw that nothing has followed

std::string Exceeds(const char* what, double value, const char* unit, double limit) {
  return value <= limit ? std::string() : Format("%s %.3g %s, limit %.3g", what, value, unit, limit);
}

/// A rotation about the vertical through the position, and a shift, in the canonical chart of a state: 15
/// x 4.
Eigen::Matrix<double, 15, 4> GaugeDirections(const NavState& state) {
  Eigen::Matrix<double, 15, 4> directions = Eigen::Matrix<double, 15, 4>::Zero();
  directions.topRows<9>() = YawShift{0, state.p_WB}.ParameterJacobian(state);
  return directions;
}

}  // namespace

std::string HealthMonitor::Check(const NavEstimate& estimate, const FrameStatistics& statistics) {
  if (!IsFinite(estimate)) {
    return "state is not finite";
  }
  if (!(estimate.covariance.diagonal().minCoeff() >= 0)) {
    return "covariance has a negative variance";
  }
  for (const std::string& reason :
       {Exceeds("speed", estimate.nav.v_WB.norm(), "m/s", config_.max_speed_mps),
        Exceeds("gyroscope bias", estimate.bias.gyro.norm(), "rad/s", config_.max_gyro_bias_radps),
        Exceeds("accelerometer bias", estimate.bias.accel.norm(), "m/s^2", config_.max_accel_bias_mps2)}) {
    if (!reason.empty()) {
      return reason;
    }
  }
  const FrameStatistics& s = statistics;
  const int failed = s.features_gated + s.features_degenerate;
  supported_ = s.at_rest || (s.features_used > 0 && s.features_used >= failed && !s.suspect);
  if (supported_) {
    in_doubt_ = false;
    return {};
  }
  if (!s.suspect && failed == 0) {
    return {};  // no information
  }
  doubted_since_ns_ = in_doubt_ ? doubted_since_ns_ : estimate.stamp_ns;
  in_doubt_ = true;
  return Exceeds("tracks contradict the state for", SecondsBetween(doubted_since_ns_, estimate.stamp_ns), "s",
                 config_.max_suspect_s);
}

NavEstimate ContinueFrom(const NavEstimate& sound, const NavEstimate& reckoned, const NavEstimate& start) {
  const double away_s = SecondsBetween(sound.stamp_ns, start.stamp_ns);
  const double speed = start.nav.v_WB.norm();
  double slip =
      (reckoned.nav.R_WB.transpose() * reckoned.nav.v_WB - start.nav.R_WB.transpose() * start.nav.v_WB)
          .norm();
  double turn_std = (reckoned.nav.R_WB.row(2) - start.nav.R_WB.row(2)).norm();
  const bool reckoning_failed = !(slip < speed + kSlipMps);
  const NavEstimate& base = reckoning_failed ? sound : reckoned;
  if (reckoning_failed) {
    slip = speed + kSlipMps;
    turn_std = kUnknownYawRad;
  }
  YawShift onto;
  onto.yaw_rad = so3::NearestYaw(base.nav.R_WB * start.nav.R_WB.transpose());
  onto.p_NW = base.nav.p_WB - onto.Rotation() * start.nav.p_WB;
  NavEstimate moved = onto * start;
  Eigen::Matrix<double, 4, 15> of_gauge = Eigen::Matrix<double, 4, 15>::Zero();
  of_gauge.block<1, 3>(0, 0) = base.nav.R_WB.row(2);
  of_gauge.block<3, 3>(1, 3).setIdentity();
  Eigen::Matrix4d gauge = of_gauge * base.covariance * of_gauge.transpose();
  gauge(0, 0) += turn_std * turn_std;
  gauge.diagonal().tail<3>().array() += slip * slip * away_s * away_s;
  const Eigen::Matrix<double, 15, 4> directions = GaugeDirections(moved.nav);
  moved.covariance += directions * gauge * directions.transpose();
  moved.covariance = (0.5 * (moved.covariance + moved.covariance.transpose())).eval();
  return moved;
}

}  // namespace alidade
