#pragma once

#include <span>

#include "core/imu_sample.h"
#include "core/navigation_state.h"

namespace alidade {

/// IMU preintegration with the midpoint rule (Forster et al. 2017; discretisation of Qin et al. 2018):
/// increments between two stamps, independent of the state except through the biases they were computed with.
///
///   alpha = integral of integral of R(t0,t) (a - ba)
///   beta  = integral of R(t0,t) (a - ba)
///   gamma = R(t0,t1)
///
/// Errors in the order (alpha, beta, theta, bg, ba), gamma = gamma^ Exp(theta). White noise acts on each
/// step's mean measurement with variance density^2/dt.
class Preintegration {
 public:
  Preintegration(const ImuBias& bias, const ImuNoise& noise) : bias_(bias), noise_(noise) {}

  /// Appends one step between two samples; stamps strictly increasing.
  void Add(const ImuSample& from, const ImuSample& to);
  /// Appends all steps of consecutive samples (at least two).
  void Add(std::span<const ImuSample> samples);

  /// Increments corrected to first order for a bias other than the one integrated with.
  struct Increments {
    Eigen::Vector3d alpha, beta;
    Eigen::Matrix3d gamma;
  };
  [[nodiscard]] Increments Corrected(const ImuBias& bias) const;

  [[nodiscard]] double duration_s() const { return duration_s_; }
  [[nodiscard]] const Eigen::Vector3d& alpha() const { return alpha_; }
  [[nodiscard]] const Eigen::Vector3d& beta() const { return beta_; }
  [[nodiscard]] const Eigen::Matrix3d& gamma() const { return gamma_; }
  [[nodiscard]] const ImuBias& bias() const { return bias_; }
  [[nodiscard]] const ImuNoise& noise() const { return noise_; }
  [[nodiscard]] const Matrix15d& jacobian() const { return jacobian_; }  ///< d error(t1) / d error(t0)
  [[nodiscard]] const Matrix15d& covariance() const { return covariance_; }

 private:
  ImuBias bias_;
  ImuNoise noise_;
  double duration_s_ = 0;
  Eigen::Vector3d alpha_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d beta_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d gamma_ = Eigen::Matrix3d::Identity();
  Matrix15d jacobian_ = Matrix15d::Identity();
  Matrix15d covariance_ = Matrix15d::Zero();
};

/// Residual of two navigation states against preintegrated increments; see core/model.h for the contract of a
/// model.
///
///   r = [ R_i^T (p_j - p_i - v_i T - g T^2/2) - alpha(b_i) ;  R_i^T (v_j - v_i - g T) - beta(b_i) ;
///         Log(gamma(b_i)^T R_i^T R_j) ;  bg_j - bg_i ;  ba_j - ba_i ]
///
/// Units m, m/s, rad, rad/s, m/s^2. Its covariance is preintegration.covariance().
struct PreintegrationModel {
  const Preintegration* preintegration;
  Eigen::Vector3d gravity_W;

  /// Jacobians over (phi, dp, dv, dbg, dba) of state i and of state j, 15x15 each; nullptr skips.
  void Evaluate(const NavState& state_i, const ImuBias& bias_i, const NavState& state_j,
                const ImuBias& bias_j, Vector15d* residual, Matrix15d* jacobian_i,
                Matrix15d* jacobian_j) const;
};

}  // namespace alidade
