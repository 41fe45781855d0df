#include "smoother/sliding/newest_update.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <variant>
#include <vector>

#include "core/imu_propagation.h"
#include "smoother/factors/measurement_factor.h"
#include "smoother/manifold/nav_state_manifold.h"

namespace alidade {
namespace {

/// At the measurement, which the IMU leads to from the frame.
NavState AtMeasurement(const ImuLink& link, const NavEstimate& state, const Eigen::Vector3d& gravity_W) {
  return link.preintegration ? CarryState(*link.preintegration, state.nav, state.bias, gravity_W, nullptr)
                             : state.nav;
}

}  // namespace

void NewestUpdate::Begin(const NavEstimate& newest, const ClockState& clock,
                         const Eigen::Matrix<double, kClock, 15>& clock_state) {
  state_ = newest;
  clock_ = clock.mean;
  covariance_ << clock.covariance, clock_state, clock_state.transpose(), newest.covariance;
}

Status NewestUpdate::Carry(std::span<const ImuSample> interval, const ImuNoise& noise,
                           const Eigen::Vector3d& gravity_W, const ClockTransition& clock) {
  Preintegration preintegration(state_.bias, noise);
  preintegration.Add(interval);
  ImuTransition transition;
  ALIDADE_RETURN_IF_ERROR(PropagateState(preintegration, gravity_W, &state_.nav, &transition));
  state_.stamp_ns = interval.back().stamp_ns;
  clock_ = clock.phi * clock_;
  Covariance phi = Covariance::Zero();
  phi.topLeftCorner<kClock, kClock>() = clock.phi;
  phi.bottomRightCorner<15, 15>() = transition.phi;
  covariance_ = phi * covariance_ * phi.transpose();
  covariance_.topLeftCorner<kClock, kClock>() += clock.q;
  covariance_.bottomRightCorner<15, 15>() += transition.q();
  return Status::Ok();
}

AbsoluteCorrection NewestUpdate::Update(const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                        const Eigen::Ref<const Eigen::VectorXd>& residual) {
  const Eigen::MatrixXd projected = covariance_ * rows.transpose();
  Eigen::MatrixXd innovation = rows * projected;
  innovation.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> factor(innovation);
  const Eigen::Matrix<double, kSize, 1> change = -projected * factor.solve(residual);
  const Covariance less = projected * factor.solve(projected.transpose());
  covariance_ -= less;
  clock_ += change.head<kClock>();
  state_.nav = Retract(ErrorConvention::kSo3xRn, state_.nav, Vector9d(change.segment<9>(kClock)));
  state_.bias.gyro += change.segment<3>(kClock + 9);
  state_.bias.accel += change.segment<3>(kClock + 12);
  return {state_.nav, change.segment<3>(kClock + 3), less.block<3, 3>(kClock + 3, kClock + 3)};
}

AbsoluteCorrection NewestUpdate::Add(const GnssFactorContext& context, double gate_threshold,
                                     const FrameEpoch& epoch, double dt_s) {
  GnssResiduals ignored;
  const FrameEpochRows rows =
      LinearizeFrameEpoch(context, epoch, dt_s, state_.nav, state_.bias, clock_, false, &ignored);
  const Eigen::Index count = rows.residual.size();
  Eigen::MatrixXd jacobian(count, kSize);
  jacobian << rows.clock, rows.frame;
  const Eigen::MatrixXd predicted = jacobian * covariance_;
  std::vector<double> nis;
  for (Eigen::Index i = 0; i < count; ++i) {
    nis.push_back(NormalisedInnovation(rows.residual[i], predicted.row(i).dot(jacobian.row(i)),
                                       rows.contradicted[static_cast<std::size_t>(i)]));
  }
  const std::vector<double> weights = WeighRows(context.config, gate_threshold, nis).weights;
  Eigen::VectorXd residual = rows.residual;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double root = std::sqrt(weights[k] * rows.information[k]);
    jacobian.row(i) *= root;
    residual[i] *= root;
  }
  AbsoluteCorrection correction = Update(jacobian, residual);
  correction.nav = AtMeasurement(epoch, state_, context.gravity_W);
  return correction;
}

AbsoluteCorrection NewestUpdate::Add(const FrameMeasurement& measurement, const Eigen::Vector3d& gravity_W) {
  AbsoluteCorrection correction = std::visit(
      [&](const auto& kind) {
        using Kind = std::decay_t<decltype(kind)>;
        constexpr int kRows = Kind::kRows;
        NavState nav = state_.nav;
        Matrix15d carry = Matrix15d::Identity();
        if (measurement.preintegration) {
          nav = CarryState(*measurement.preintegration, nav, state_.bias, gravity_W, &carry);
        }
        typename Kind::Residual residual;
        typename Kind::Jacobian jacobian;
        kind.Evaluate(nav, &residual, &jacobian);
        Eigen::Matrix<double, kRows, kSize> rows = Eigen::Matrix<double, kRows, kSize>::Zero();
        rows.template rightCols<15>() = jacobian * carry;
        return Update(rows, residual);
      },
      measurement.measurement);
  correction.nav = AtMeasurement(measurement, state_, gravity_W);
  return correction;
}

}  // namespace alidade
