#include "eval/truth_start.h"

#include <algorithm>

#include "core/random.h"

namespace alidade {
namespace {

constexpr double kMaxGapS = 0.1;

}  // namespace

Result<TrajectoryPoint> InterpolateTruth(const Trajectory& truth, TimeNs stamp_ns) {
  const std::vector<TrajectoryPoint>& points = truth.points;
  const auto after =
      std::lower_bound(points.begin(), points.end(), stamp_ns,
                       [](const TrajectoryPoint& p, TimeNs stamp) { return p.stamp_ns < stamp; });
  if (after != points.end() && after->stamp_ns == stamp_ns) {
    return *after;
  }
  if (after == points.begin() || after == points.end()) {
    return Status::Input("truth does not cover " + FormatSeconds(stamp_ns) + " s" +
                         (points.empty() ? std::string(": it is empty")
                                         : ": it spans " + FormatSeconds(points.front().stamp_ns) + " s to " +
                                               FormatSeconds(points.back().stamp_ns) + " s"));
  }
  const TrajectoryPoint& a = *(after - 1);
  const TrajectoryPoint& b = *after;
  if (SecondsBetween(a.stamp_ns, b.stamp_ns) > kMaxGapS) {
    return Status::Input("truth has a gap around " + FormatSeconds(stamp_ns) + " s");
  }
  const double w = SecondsBetween(a.stamp_ns, stamp_ns) / SecondsBetween(a.stamp_ns, b.stamp_ns);
  TrajectoryPoint point;
  point.stamp_ns = stamp_ns;
  point.nav.R_WB = a.nav.R_WB * so3::Exp(w * so3::Log(a.nav.R_WB.transpose() * b.nav.R_WB));
  point.nav.p_WB = (1 - w) * a.nav.p_WB + w * b.nav.p_WB;
  point.nav.v_WB = (1 - w) * a.nav.v_WB + w * b.nav.v_WB;
  point.bias.gyro = (1 - w) * a.bias.gyro + w * b.bias.gyro;
  point.bias.accel = (1 - w) * a.bias.accel + w * b.bias.accel;
  return point;
}

Result<NavEstimate> StartFromTruth(const InitConfig& config, const Trajectory& truth, TimeNs stamp_ns,
                                   unsigned seed) {
  if (!truth.has_velocity || !truth.has_bias) {
    return Status::Input(std::string("init.method: found truth, but the ground truth has no ") +
                         (!truth.has_velocity ? "velocity" : "bias") +
                         " columns; expected static, dynamic or auto for this sequence");
  }
  const Result<TrajectoryPoint> point = InterpolateTruth(truth, stamp_ns);
  if (!point.ok()) {
    return point.status();
  }
  // Drawn even when not applied, each from a named stream's fixed place: no option shifts another draw.
  RandomStream random(seed, "initial_state");
  const double scale = config.perturb_truth ? 1 : 0;
  const Eigen::Vector3d attitude_std(config.tilt_std_rad, config.tilt_std_rad, config.yaw_std_rad);
  const Eigen::Vector3d theta_W = scale * attitude_std.cwiseProduct(random.Normal3());

  NavEstimate start;
  start.stamp_ns = stamp_ns;
  start.nav.R_WB = so3::Exp(-theta_W) * point->nav.R_WB;
  start.nav.p_WB = point->nav.p_WB - scale * config.position_std_m * random.Normal3();
  start.nav.v_WB = point->nav.v_WB - scale * config.velocity_std_mps * random.Normal3();
  start.bias.gyro = point->bias.gyro - scale * config.gyro_bias_std_radps * random.Normal3();
  start.bias.accel = point->bias.accel - scale * config.accel_bias_std_mps2 * random.Normal3();

  const Eigen::Matrix3d attitude_covariance =
      start.nav.R_WB.transpose() * attitude_std.cwiseAbs2().asDiagonal() * start.nav.R_WB;
  start.covariance.block<3, 3>(0, 0) = 0.5 * (attitude_covariance + attitude_covariance.transpose());
  Eigen::Matrix<double, 12, 1> deviations;
  deviations << Eigen::Vector3d::Constant(config.position_std_m),
      Eigen::Vector3d::Constant(config.velocity_std_mps),
      Eigen::Vector3d::Constant(config.gyro_bias_std_radps),
      Eigen::Vector3d::Constant(config.accel_bias_std_mps2);
  start.covariance.diagonal().tail<12>() = deviations.cwiseAbs2();
  return start;
}

}  // namespace alidade
