#include "eval/simulation/sim_fix.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/lever_arm.h"
#include "core/random.h"
#include "eval/simulation/sim_fault.h"

namespace alidade {

using Eigen::Vector3d;

void AddSimulatedFixes(const SimulatorConfig& config, const ContinuousTrajectory& trajectory, TimeNs start_ns,
                       std::uint64_t seed, Dataset* dataset) {
  const SimFixConfig& fix_config = config.fix;
  if (fix_config.rate_hz <= 0) {
    return;
  }
  const SimPull pull(config, seed);
  RandomStream noise(seed, "fix.noise");
  RandomStream wrong(seed, "fix.wrong");
  FixSensor sensor{fix_config.lever_arm_m, fix_config.time_offset_s, std::nullopt};
  Eigen::Matrix3d R_FW = Eigen::Matrix3d::Identity();
  Vector3d p_FW = Vector3d::Zero();
  if (fix_config.own_frame) {
    R_FW = Eigen::AngleAxisd(fix_config.frame_yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
    p_FW = fix_config.frame_shift_m;
  } else {
    const SimGnssConfig& anchor = config.gnss;
    sensor.anchor_llh_deg =
        Vector3d(anchor.anchor_latitude_deg, anchor.anchor_longitude_deg, anchor.anchor_height_m);
  }
  const Vector3d deviations = fix_config.std_m * Vector3d(1, 1, fix_config.up_factor);
  const TimeNs offset_ns = SecondsToNs(fix_config.time_offset_s);
  const TimeNs period_ns = SecondsToNs(1 / fix_config.rate_hz);
  const TimeNs first_ns = ((start_ns - offset_ns) / period_ns + 1) * period_ns;
  const TimeNs end_ns = start_ns - offset_ns + SecondsToNs(trajectory.DurationSeconds());
  for (TimeNs stamp_ns = first_ns; stamp_ns < end_ns; stamp_ns += period_ns) {
    const double time_s = SecondsBetween(start_ns, stamp_ns + offset_ns);
    const NavState nav = trajectory.At(time_s).nav;
    const Vector3d error_W = deviations.cwiseProduct(noise.Normal3());
    const bool is_wrong = wrong.Chance(fix_config.wrong_rate);
    const double size_m = wrong.Uniform(fix_config.wrong_min_m, fix_config.wrong_max_m);
    const double angle_rad = wrong.Uniform(0, 2 * M_PI);
    const bool is_out = fix_config.outage_start_s >= 0 && time_s >= fix_config.outage_start_s &&
                        time_s < fix_config.outage_start_s + fix_config.outage_s;
    if (is_out) {
      continue;
    }
    Vector3d p_WA = LeverArm{sensor.p_BA}.Position(nav) + error_W + pull.At(time_s);
    if (is_wrong) {
      p_WA += size_m * Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0);
    }
    // The deviation is that of a turned frame too: the same towards east and north.
    dataset->fixes.push_back(
        {stamp_ns, 0, R_FW * p_WA + p_FW, Eigen::Matrix3d(deviations.cwiseAbs2().asDiagonal())});
  }
  dataset->rig.fixes.push_back(sensor);
}

}  // namespace alidade
