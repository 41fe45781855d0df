#pragma once

#include <atomic>
#include <span>
#include <vector>

#include "core/status.h"
#include "smoother/truth/truth_poses.h"
#include "smoother/truth/truth_terms.h"

namespace alidade {

struct TruthRefinementOptions {
  ImuNoise imu_noise;
  double gravity_mps2 = 9.81;
  /// Poses beyond this quantile of the chi-square distribution (3 degrees of freedom), in orientation or in
  /// position, are refused.
  double gate_probability = 0.9999;
  /// Longer without a pose that is used is a span without truth.
  double max_gap_s = 0.1;
  bool imu_scale = false;  ///< estimate TruthImuScale, else the readings are taken as they are
  TruthNoise noise;        ///< a positive deviation is taken as given, else it is estimated
  const std::atomic<bool>* stop = nullptr;  ///< polled once an iteration; may be null
};

struct RefinedTruth {
  /// At the IMU's stamps from the first to the last pose that is used; W: TruthConstants.
  std::vector<NavEstimate> states;
  TruthConstants constants;
  TruthConstantsCovariance constants_covariance = TruthConstantsCovariance::Zero();
  /// With TruthRefinementOptions::imu_scale, and deviations of its entries: gyroscope, accelerometer.
  TruthImuScale imu_scale;
  Vector6d imu_scale_std = Vector6d::Zero();
  TruthNoise noise;
  TruthNoise noise_std;  ///< standard deviations of the two deviations
  size_t poses = 0;      ///< within the IMU's time
  size_t refused = 0;    ///< of them
  TruthFit orientation, position;
  TruthFit gyro, accel;            ///< white noise of the IMU
  TruthFit gyro_walk, accel_walk;  ///< of the biases
  /// Correlation time of the residuals in poses: 1 + 2 sum of the autocorrelation up to where it falls below
  /// 0.05. So many successive poses hold as much information as one with independent noise; 1 where the noise
  /// of the truth is white. Where it is not, the covariances are too small: fewer poses, or a larger noise.
  double orientation_correlation = 1, position_correlation = 1;
  std::vector<TruthSpan> spans;  ///< without poses that are used
  int imu_gaps = 0;              ///< steps of the IMU of more than ten times the median
  int iterations = 0;
  double distance_sigma = 0;  ///< to the minimum of the last linearised problem, in standard deviations
};

/// The maximum-a-posteriori estimate of the motion at the stamps of the IMU from all its samples and recorded
/// poses (the idea of Geneva and Huang, "vicon2gt: Derivations and Analysis", 2020). Unknowns: pose, velocity
/// and biases at every IMU sample between the poses, TruthConstants, and the noise of the poses.
///
///   1. StartTruth; iterations with a Huber kernel, the noise from the median of the residuals.
///   2. Gauss-Newton iterations (ArrowSystem) with the poses that the gate lets pass and the noise of maximum
///      likelihood, sigma^2 = sigma_0^2 chi_square / dof (variance components; Koch 1999; FixedPoint), at
///      least 1e-5 rad and 0.01 mm, until poses, noise and states stand: distance to the minimum below 0.01
///      standard deviations.
///
/// Steps between samples: Preintegration. A pose between two samples is compared with the state before it,
/// carried there by the IMU; the noise of that fraction of a step is neglected. Weak priors of zero mean hold
/// what nothing determines: the first biases (1 rad/s, 10 m/s^2), and the constants about their initial
/// values (1 rad, 1 rad, 10 m, 1 s; factors of the IMU 0.02).
///
/// kInput: fewer than 10 poses within the IMU's time, a noise density that is not positive, samples that are
/// not finite. kDiverged: the normal equations are not positive definite, or 40 iterations do not suffice, or
/// `stop`.
Result<RefinedTruth> RefineTruth(std::span<const ImuSample> imu, std::span<const TruthPose> poses,
                                 const TruthRefinementOptions& options);

}  // namespace alidade
