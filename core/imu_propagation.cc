#include "core/imu_propagation.h"

#include "core/check.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Rows3x15 = Eigen::Matrix<double, 3, 15>;

/// d (Gamma_m(phi) a) / d phi, m in {1, 2}: term-by-term derivative of Gamma_m = I/m! + a [phi]x + b
/// [phi]x^2, whose coefficients are power series in |phi|^2.
Matrix3d GammaVectorDerivative(const Vector3d& phi, const Vector3d& v, int m) {
  const double t2 = phi.squaredNorm();
  double a = 0;
  double b = 0;
  double a_slope = 0;  // (1/theta) d a / d theta
  double b_slope = 0;
  double a_term = m == 1 ? 1.0 / 2 : 1.0 / 6;
  double b_term = m == 1 ? 1.0 / 6 : 1.0 / 24;
  for (int j = 0; j < 30; ++j) {
    a += a_term;
    b += b_term;
    const double a_next = -a_term / ((2 * j + 2 + m) * (2 * j + 3 + m));
    const double b_next = -b_term / ((2 * j + 3 + m) * (2 * j + 4 + m));
    a_slope += 2 * (j + 1) * a_next;
    b_slope += 2 * (j + 1) * b_next;
    a_term = a_next * t2;
    b_term = b_next * t2;
    if (std::abs(a_term) < 1e-18) {
      break;
    }
  }
  const Vector3d phi_v = phi.cross(v);
  Matrix3d derivative = -a * Skew(v) - b * (Skew(phi_v) + Skew(phi) * Skew(v));
  derivative += (a_slope * phi_v + b_slope * phi.cross(phi_v)) * phi.transpose();
  return derivative;
}

/// The nonzero 3x3 blocks of one step's phi; rows phi, dp, dv over (phi, dp, dv, dbg, dba).
struct StepBlocks {
  Matrix3d phi_phi, phi_bg;
  Matrix3d p_phi, p_bg, p_ba;
  Matrix3d v_phi, v_bg, v_ba;
  double dt = 0;

  /// step * m, touching only nonzero blocks.
  [[nodiscard]] Matrix15d TimesLeft(const Matrix15d& m) const {
    Matrix15d out;
    const Rows3x15 phi = m.middleRows<3>(0);
    const Rows3x15 bg = m.middleRows<3>(9);
    const Rows3x15 ba = m.middleRows<3>(12);
    out.middleRows<3>(0).noalias() = phi_phi * phi + phi_bg * bg;
    out.middleRows<3>(3) = m.middleRows<3>(3) + dt * m.middleRows<3>(6);
    out.middleRows<3>(3).noalias() += p_phi * phi + p_bg * bg + p_ba * ba;
    out.middleRows<3>(6) = m.middleRows<3>(6);
    out.middleRows<3>(6).noalias() += v_phi * phi + v_bg * bg + v_ba * ba;
    out.bottomRows<6>() = m.bottomRows<6>();
    return out;
  }
};

void AddSymmetric(Matrix15d* q, int row, int col, const Matrix3d& block) {
  q->block<3, 3>(row, col) += block;
  if (row != col) {
    q->block<3, 3>(col, row) += block.transpose();
  }
}

/// Integral of the noise response over the step; R a is held at its value in the step's middle.
void AddStepNoise(const Matrix3d& R_mid, const Matrix3d& R_end, const Vector3d& accel, double dt,
                  const ImuNoise& noise, Matrix15d* q) {
  const double g2 = noise.gyro_noise_density_radps_sqrthz * noise.gyro_noise_density_radps_sqrthz;
  const double a2 = noise.accel_noise_density_mps2_sqrthz * noise.accel_noise_density_mps2_sqrthz;
  const double wg2 = noise.gyro_random_walk_radps2_sqrthz * noise.gyro_random_walk_radps2_sqrthz;
  const double wa2 = noise.accel_random_walk_mps3_sqrthz * noise.accel_random_walk_mps3_sqrthz;
  const Matrix3d I = Matrix3d::Identity();
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  const Matrix3d A = R_mid * Skew(accel);  // velocity gained per attitude error (frame of the middle)
  const Matrix3d to_end = R_end.transpose() * R_mid;  // attitude error of the middle, seen from the end
  const Matrix3d AtE = A * to_end.transpose();
  const Matrix3d AAt = A * A.transpose();
  // Gyroscope white noise: phi: -1, v: A s, p: A s^2/2 after a lag s.
  AddSymmetric(q, 0, 0, g2 * dt * I);
  AddSymmetric(q, 6, 0, -g2 * dt2 / 2 * AtE);
  AddSymmetric(q, 3, 0, -g2 * dt3 / 6 * AtE);
  AddSymmetric(q, 6, 6, (g2 * dt3 / 3) * AAt + a2 * dt * I);
  AddSymmetric(q, 3, 6, (g2 * dt3 * dt / 8) * AAt + a2 * dt2 / 2 * I);
  AddSymmetric(q, 3, 3, (g2 * dt3 * dt2 / 20) * AAt + a2 * dt3 / 3 * I);
  // Bias walks: gyro phi: -s, v: A s^2/2, p: A s^3/6; accelerometer v: -R s, p: -R s^2/2.
  AddSymmetric(q, 9, 9, wg2 * dt * I);
  AddSymmetric(q, 0, 9, -wg2 * dt2 / 2 * to_end);
  AddSymmetric(q, 0, 0, wg2 * dt3 / 3 * I);
  AddSymmetric(q, 6, 9, wg2 * dt3 / 6 * A);
  AddSymmetric(q, 3, 9, wg2 * dt3 * dt / 24 * A);
  AddSymmetric(q, 12, 12, wa2 * dt * I);
  AddSymmetric(q, 6, 12, -wa2 * dt2 / 2 * R_mid);
  AddSymmetric(q, 3, 12, -wa2 * dt3 / 6 * R_mid);
  AddSymmetric(q, 6, 6, wa2 * dt3 / 3 * I);
  AddSymmetric(q, 3, 6, wa2 * dt3 * dt / 8 * I);
}

}  // namespace

void PropagateStep(const Vector3d& omega, const Vector3d& accel, double dt_s, const ImuNoise& noise,
                   const Vector3d& gravity_W, NavState* state, ImuTransition* transition) {
  const Vector3d angle = omega * dt_s;
  const Matrix3d delta = so3::Exp(angle);
  const Matrix3d gamma_1 = so3::Gamma(angle, 1);
  const Matrix3d gamma_2 = so3::Gamma(angle, 2);
  const Matrix3d R = state->R_WB;
  const double dt2 = dt_s * dt_s;
  if (transition != nullptr) {
    StepBlocks step;
    step.dt = dt_s;
    step.phi_phi = delta.transpose();
    step.phi_bg = -gamma_1.transpose() * dt_s;  // right Jacobian
    step.v_phi = -R * Skew(gamma_1 * accel) * dt_s;
    step.v_bg = -R * GammaVectorDerivative(angle, accel, 1) * dt2;
    step.v_ba = -R * gamma_1 * dt_s;
    step.p_phi = -R * Skew(gamma_2 * accel) * dt2;
    step.p_bg = -R * GammaVectorDerivative(angle, accel, 2) * dt2 * dt_s;
    step.p_ba = -R * gamma_2 * dt2;
    transition->phi = step.TimesLeft(transition->phi);
    const Matrix15d half = step.TimesLeft(transition->q).transpose();
    transition->q = step.TimesLeft(half);
    AddStepNoise(R * so3::Exp(0.5 * angle), R * delta, accel, dt_s, noise, &transition->q);
  }
  state->p_WB += state->v_WB * dt_s + 0.5 * dt2 * gravity_W + R * (gamma_2 * accel) * dt2;
  state->v_WB += gravity_W * dt_s + R * (gamma_1 * accel) * dt_s;
  state->R_WB = R * delta;
}

void PropagateImu(std::span<const ImuSample> samples, const ImuBias& bias, const ImuNoise& noise,
                  const Vector3d& gravity_W, NavState* state, ImuTransition* transition) {
  CHECK_GE(samples.size(), 2u);
  for (size_t k = 0; k + 1 < samples.size(); ++k) {
    const Vector3d omega = 0.5 * (samples[k].gyro + samples[k + 1].gyro) - bias.gyro;
    const Vector3d accel = 0.5 * (samples[k].accel + samples[k + 1].accel) - bias.accel;
    PropagateStep(omega, accel, SecondsBetween(samples[k].stamp_ns, samples[k + 1].stamp_ns), noise,
                  gravity_W, state, transition);
  }
}

}  // namespace alidade
