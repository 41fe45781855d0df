#include "frontend/initialization/dynamic_initializer.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "frontend/initialization/dynamic_window.h"
#include "frontend/initialization/gyro_bias_fit.h"
#include "frontend/initialization/linear_start.h"
#include "frontend/initialization/start_refinement.h"

namespace alidade {
namespace {

// The gyroscope's turn-on bias is found from vision, whatever the configured prior: 0.08 rad/s on EuRoC.
constexpr double kGyroBiasStdRadps = 0.1;
constexpr int kMinWindowTracks = 15;
// The pixel noise is a setting, not a measurement: twice too low still passes.
constexpr double kMaxReprojectionChi2 = 4.0;
constexpr double kMaxInertialChi2 = 3.0;
constexpr double kMaxBiasPriorSigma = 4.0;
constexpr double kMaxGyroBiasRadps = 0.3;
constexpr double kMaxRejectedFraction = 0.6;

// Vibration is not white: averaged over an interval it counts for less than its spread. With this
// bound the errors of starts on recorded IMU data are about those of their covariance
// (docs/initialization.md).
constexpr double kMaxVibrationFactor = 4.0;

/// How much noisier the samples are than white noise of this density, at least 1 and at most
/// kMaxVibrationFactor. Second differences leave out motion, which changes little from sample to sample.
double VibrationFactor(const DynamicWindow& window, const Eigen::Vector3d ImuSample::*signal,
                       double density) {
  double sum = 0;
  double count = 0;
  double duration_s = 0;
  double steps = 0;
  for (const std::vector<ImuSample>& samples : window.imu) {
    for (size_t i = 1; i + 1 < samples.size(); ++i) {
      const Eigen::Vector3d second = samples[i + 1].*signal - 2 * samples[i].*signal + samples[i - 1].*signal;
      sum += second.squaredNorm() / (3 * 6);  // 1 + 4 + 1: of white noise
      ++count;
    }
    duration_s += SecondsBetween(samples.front().stamp_ns, samples.back().stamp_ns);
    steps += static_cast<double>(samples.size()) - 1;
  }
  if (!(count > 0) || !(steps > 0) || !(density > 0)) {
    return 1;
  }
  return std::clamp(std::sqrt(sum / count * duration_s / steps) / density, 1.0, kMaxVibrationFactor);
}

ImuNoise NoiseInMotion(const DynamicWindow& window, ImuNoise noise) {
  noise.gyro_noise_density_radps_sqrthz *=
      VibrationFactor(window, &ImuSample::gyro, noise.gyro_noise_density_radps_sqrthz);
  noise.accel_noise_density_mps2_sqrthz *=
      VibrationFactor(window, &ImuSample::accel, noise.accel_noise_density_mps2_sqrthz);
  return noise;
}

/// Empty when the solution may be used.
std::string ReasonAgainst(const RefinedStart& refined, double max_scale_std) {
  if (refined.reprojection_chi2 > kMaxReprojectionChi2) {
    return Format("moving: reprojection chi-square %.2f a degree of freedom, limit %.1f",
                  refined.reprojection_chi2, kMaxReprojectionChi2);
  }
  if (refined.inertial_chi2 > kMaxInertialChi2) {
    return Format("moving: inertial chi-square %.2f a degree of freedom, limit %.1f", refined.inertial_chi2,
                  kMaxInertialChi2);
  }
  if (refined.rejected_tracks > kMaxRejectedFraction * (refined.tracks + refined.rejected_tracks)) {
    return Format("moving: %d tracks do not fit, %d do", refined.rejected_tracks, refined.tracks);
  }
  if (refined.newest.bias.gyro.norm() > kMaxGyroBiasRadps) {
    return Format("moving: gyro bias %.3f rad/s is implausible, limit %.1f", refined.newest.bias.gyro.norm(),
                  kMaxGyroBiasRadps);
  }
  if (refined.bias_prior_sigma > kMaxBiasPriorSigma) {
    return Format("moving: accelerometer bias is %.1f deviations of its prior, limit %.0f",
                  refined.bias_prior_sigma, kMaxBiasPriorSigma);
  }
  if (refined.relative_scale_std > max_scale_std) {
    return Format("moving: scale is known to %.1f %%, need %.1f %%", 100 * refined.relative_scale_std,
                  100 * max_scale_std);
  }
  return {};
}

}  // namespace

Result<DynamicSolution> InitializeDynamic(const EstimatorConfig& config, const RigCalibration& rig,
                                          const std::deque<TrackFrame>& frames, const DynamicLimits& limits,
                                          ImuBuffer* imu, Eigen::Vector3d* accel_bias) {
  DynamicWindow window;
  ALIDADE_RETURN_IF_ERROR(BuildDynamicWindow(config, rig.camera, frames, limits.longest_s, imu, &window));
  if (static_cast<int>(window.tracks.size()) < kMinWindowTracks) {
    return Status::Diverged(Format("moving: %zu tracks shared by frames of the window, need %d",
                                   window.tracks.size(), kMinWindowTracks));
  }
  const ImuNoise noise = NoiseInMotion(window, rig.imu_noise);
  std::vector<Preintegration> preintegrations = PreintegrateWindow(window, ImuBias(), noise);
  const GyroBiasFit gyro = FitGyroBias(window, preintegrations, rig);
  if (gyro.median_parallax_px < config.init.dynamic_min_parallax_px) {
    return Status::Diverged(Format("moving: parallax %.1f px of %.1f", gyro.median_parallax_px,
                                   config.init.dynamic_min_parallax_px));
  }
  const ImuBias bias{gyro.gyro_bias, *accel_bias};
  preintegrations = PreintegrateWindow(window, bias, noise);
  const Result<LinearStart> linear =
      SolveLinearStart(window, preintegrations, bias, gyro.inlier, rig.T_BC, config.imu.gravity_mps2);
  if (!linear.ok()) {
    return linear.status();
  }
  RefinementSettings settings;
  settings.T_BC = rig.T_BC;
  settings.gravity_mps2 = config.imu.gravity_mps2;
  settings.accel_bias_std_mps2 = config.init.accel_bias_std_mps2;
  settings.gyro_bias_std_radps = kGyroBiasStdRadps;
  settings.yaw_std_rad = config.init.yaw_std_rad;
  settings.position_std_m = config.init.position_std_m;
  const Result<RefinedStart> refined =
      RefineStart(window, gyro.inlier, preintegrations, linear->states, linear->bias, settings);
  if (!refined.ok()) {
    return refined.status();
  }
  const bool plausible = refined->bias_prior_sigma <= kMaxBiasPriorSigma;
  *accel_bias = plausible ? refined->newest.bias.accel : Eigen::Vector3d::Zero();
  if (const std::string reason = ReasonAgainst(*refined, limits.scale_std); !reason.empty()) {
    return Status::Diverged(reason);
  }
  const std::string report = Format(
      "in motion: %zu frames over %.2f s, %d tracks (%d refused), parallax %.0f px, scale known to %.1f %%, "
      "reprojection chi2 %.2f, inertial chi2 %.2f, free gravity %.2f m/s^2, speed %.2f m/s, %d iterations",
      window.stamps_ns.size(), SecondsBetween(window.stamps_ns.front(), window.stamps_ns.back()),
      refined->tracks, refined->rejected_tracks, gyro.median_parallax_px, 100 * refined->relative_scale_std,
      refined->reprojection_chi2, refined->inertial_chi2, linear->free_gravity_mps2,
      refined->newest.nav.v_WB.norm(), refined->iterations);
  return DynamicSolution{
      refined->newest, report, {window.stamps_ns, refined->states, refined->relative_scale_std}};
}

}  // namespace alidade
