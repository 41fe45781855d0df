#include "eval/record/truth_start.h"

#include "core/random.h"
#include "eval/dataset/log_hasher.h"
#include "eval/trajectory/trajectory_interpolation.h"

namespace alidade {

Status CheckTruthForStart(const Trajectory& truth) {
  if (!truth.has_velocity || !truth.has_bias) {
    return Status::Input(std::string("init.method: found truth, but the ground truth has no ") +
                         (!truth.has_velocity ? "velocity" : "bias") +
                         " columns; expected static, dynamic or auto for this sequence");
  }
  return Status::Ok();
}

std::string DigestOfStartTruth(const InitConfig& config, const Trajectory* truth) {
  if (config.method != InitMethod::kTruth || truth == nullptr) {
    return {};
  }
  LogHasher hasher;
  hasher.Add(std::uint64_t{truth->has_velocity});
  hasher.Add(std::uint64_t{truth->has_bias});
  for (const TrajectoryPoint& point : truth->points) {
    hasher.Add(point.stamp_ns);
    hasher.Add(point.nav.R_WB);
    hasher.Add(point.nav.p_WB);
    hasher.Add(point.nav.v_WB);
    hasher.Add(point.bias.gyro);
    hasher.Add(point.bias.accel);
  }
  return hasher.Hex();
}

Result<NavEstimate> StartFromTruth(const InitConfig& config, const Trajectory& truth, TimeNs stamp_ns,
                                   unsigned seed) {
  ALIDADE_RETURN_IF_ERROR(CheckTruthForStart(truth));
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
