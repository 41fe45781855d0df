#pragma once

#include <span>

#include "core/imu_increment.h"
#include "core/navigation_state.h"

namespace alidade {

/// The IMU between two stamps, integrated with given biases: the one model of the IMU that the filter, the
/// smoother, the batch solution and the initialisers consume. A step between two samples is that of a
/// constant rate and force (MeanOverStep, StepIncrement), to which the effect of the force's change on the
/// position is added. It depends on the two samples alone, so intervals that meet at a sample compose.
///
/// Samples that are not finite, or so large that a number overflows, show in NoiseRoot and Whitening.
class Preintegration {
 public:
  Preintegration(const ImuBias& bias, const ImuNoise& noise) : bias_(bias), noise_(noise) {}

  /// Appends one step between two samples with the given densities and the noise of faulty axes of the
  /// second; stamps strictly increasing.
  void Add(const ImuSample& from, const ImuSample& to) { Add(from, to, noise_); }
  /// Appends all steps of consecutive samples, with their vibration as white noise where the noise model has
  /// it, and what a silence of the IMU hides (core/imu_gap.h); fewer than two add nothing.
  void Add(std::span<const ImuSample> samples);

  /// The motion corrected to first order for a bias at t0 other than the one integrated with.
  [[nodiscard]] ImuMotion Corrected(const ImuBias& bias) const;
  /// The same with the derivative of its error (theta, alpha, beta) over (bg, ba) at that bias.
  [[nodiscard]] ImuMotion Corrected(const ImuBias& bias, ImuIncrement::BiasJacobian* jacobian) const;

  /// Lower triangular L, covariance = L L^T. False when the covariance is not finite or not positive
  /// semi-definite.
  [[nodiscard]] bool NoiseRoot(Matrix15d* root) const;
  /// Lower triangular L^-1, which whitens the error. False when NoiseRoot fails or the covariance is
  /// singular: all four noises must be positive, and the interval not empty.
  [[nodiscard]] bool Whitening(Matrix15d* whitening) const;

  [[nodiscard]] double duration_s() const { return increment_.motion.duration_s; }
  [[nodiscard]] const ImuMotion& motion() const { return increment_.motion; }
  [[nodiscard]] const ImuIncrement::BiasJacobian& bias_jacobian() const { return increment_.bias_jacobian; }
  [[nodiscard]] const Matrix15d& covariance() const { return increment_.covariance; }
  [[nodiscard]] const ImuBias& bias() const { return bias_; }
  [[nodiscard]] const ImuNoise& noise() const { return noise_; }

 private:
  void Add(const ImuSample& from, const ImuSample& to, const ImuNoise& noise);

  ImuBias bias_;
  ImuNoise noise_;
  ImuIncrement increment_;
};

/// Residual of two navigation states against the IMU between them; see core/model.h for the contract of a
/// model.
///
///   r = [ Log(gamma(b_i)^T R_i^T R_j) ;  R_i^T (p_j - p_i - v_i T - g T^2/2) - alpha(b_i) ;
///         R_i^T (v_j - v_i - g T) - beta(b_i) ;  bg_j - bg_i ;  ba_j - ba_i ]
///
/// Units rad, m, m/s, rad/s, m/s^2. Its covariance is preintegration->covariance().
struct PreintegrationModel {
  const Preintegration* preintegration;
  Eigen::Vector3d gravity_W;

  /// Jacobians over (phi, dp, dv, dbg, dba) of state i and of state j, 15x15 each; nullptr skips.
  void Evaluate(const NavState& state_i, const ImuBias& bias_i, const NavState& state_j,
                const ImuBias& bias_j, Vector15d* residual, Matrix15d* jacobian_i,
                Matrix15d* jacobian_j) const;
};

}  // namespace alidade
