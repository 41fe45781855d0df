#include "gnss/alignment/inertial_fit.h"

#include "core/dense_solvers.h"
#include "core/error_convention.h"
#include "core/imu_buffer.h"
#include "core/imu_propagation.h"
#include "core/lever_arm.h"
#include "gnss/alignment/antenna_at_epoch.h"
#include "gnss/model/measurement_model.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kIntegrations = 2;
constexpr int kStepsPerIntegration = 5;

/// The rotation that turns the vectors `from` into `to` best (Kabsch).
Matrix3d RotationBetween(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to) {
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    sum += to[i] * from[i].transpose();
  }
  return so3::Normalize(sum);
}

}  // namespace

/// Normal equations over the error of the state at the first point, canonical chart.
struct InertialFitter::Equations {
  Matrix15d hessian = Matrix15d::Zero();
  Vector15d gradient = Vector15d::Zero();
  double cost = 0;  ///< robust

  /// `jacobian`: of the residual over the state at its point; `chain`: of that state over the first.
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

InertialFitter::InertialFitter(const EstimatorConfig& config, const RigCalibration& rig)
    : init_(config.init),
      kernel_{config.gnss.robust_kernel, config.gnss.robust_scale_sigma},
      p_BA_(rig.gnss.p_BA),
      noise_(config.imu.Scaled(rig.imu_noise)),
      gravity_W_(GravityInWorld(config.imu.gravity_mps2)) {}

bool InertialFitter::Integrate(const InertialWindow& window, double offset_s, InertialFit* fit) const {
  constexpr double kAnyGapS = 1e6;
  ImuBuffer buffer(kAnyGapS);
  for (const ImuSample& sample : window.imu) {
    (void)buffer.Add(sample);
  }
  Preintegration sum(fit->bias, noise_);
  fit->intervals.clear();
  fit->gyro_radps.clear();
  fit->first_ns = window.points.front().stamp_ns + SecondsToNs(offset_s);
  TimeNs from = fit->first_ns;
  std::vector<ImuSample> samples;
  for (std::size_t k = 1; k < window.points.size(); ++k) {
    const TimeNs to = window.points[k].stamp_ns + SecondsToNs(offset_s);
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

NavState InertialFitter::FirstGuess(const InertialWindow& window, const InertialFit& fit) const {
  const Matrix3d R_NE = window.enu->R_EN.transpose();
  const InertialPoint& first = window.points.front();
  std::vector<Vector3d> sensed;
  std::vector<Vector3d> seen;
  for (std::size_t k = 0; k < fit.intervals.size(); ++k) {
    sensed.push_back(fit.intervals[k].motion().beta);
    seen.push_back(R_NE * (window.points[k + 1].velocity_E - first.velocity_E) -
                   fit.intervals[k].duration_s() * gravity_W_);
  }
  NavState nav;
  nav.R_WB = RotationBetween(sensed, seen);
  nav.v_WB = R_NE * first.velocity_E;
  nav.p_WB = window.enu->FromEcef(first.position_E) - LeverArm{p_BA_}.Position(nav);
  return nav;
}

InertialFitter::Equations InertialFitter::Linearize(const InertialWindow& window,
                                                    const InertialFit& fit) const {
  const AntennaMount mount{*window.enu, p_BA_};
  Equations equations;
  for (std::size_t k = 0; k < window.points.size(); ++k) {
    const AntennaAtEpoch at = PredictAntenna(mount, k > 0 ? &fit.intervals[k - 1] : nullptr, gravity_W_,
                                             fit.nav, fit.bias, fit.gyro_radps[k]);
    equations.Add(at.position_E - window.points[k].position_E, at.position_jacobian, at.chain,
                  window.points[k].position_root, kernel_);
    equations.Add(at.velocity_E - window.points[k].velocity_E, at.velocity_jacobian, at.chain,
                  window.points[k].velocity_root, kernel_);
  }
  equations.AddPrior(9, fit.bias.gyro, init_.gyro_bias_std_radps);
  equations.AddPrior(12, fit.bias.accel, init_.accel_bias_std_mps2);
  return equations;
}

InertialFit InertialFitter::Solve(const InertialWindow& window, double offset_s) const {
  InertialFit fit;
  for (int iteration = 0; iteration < kIntegrations * kStepsPerIntegration; ++iteration) {
    // Over tens of seconds a bias of 5 mrad/s is beyond the increments' first order.
    if (iteration % kStepsPerIntegration == 0 && !Integrate(window, offset_s, &fit)) {
      return fit;
    }
    if (iteration == 0) {
      fit.nav = FirstGuess(window, fit);
    }
    const Equations equations = Linearize(window, fit);
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

NavState InertialFitter::LastState(const InertialFit& fit, Matrix15d* chain) const {
  return CarryState(fit.intervals.back(), fit.nav, fit.bias, gravity_W_, chain);
}

}  // namespace alidade
