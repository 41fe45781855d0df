#include "smoother/factors/gnss_factors.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/check.h"
#include "core/imu_propagation.h"
#include "core/robust.h"
#include "smoother/factors/imu_factor.h"

namespace alidade {
namespace {

using Eigen::Index;

}  // namespace

FrameEpochRows LinearizeFrameEpoch(const GnssFactorContext& context, const FrameEpoch& epoch, double dt_s,
                                   const NavState& nav, const ImuBias& bias, const Vector6d& clock,
                                   bool robust, GnssResiduals* residuals) {
  Matrix15d carry = Matrix15d::Identity();
  GnssPoint point;
  point.nav =
      epoch.preintegration ? CarryState(*epoch.preintegration, nav, bias, context.gravity_W, &carry) : nav;
  point.bias = bias;
  point.gyro_radps = epoch.gyro_radps;
  point.clock = clock;
  point.clock[ClockState::kClock] += dt_s * clock[ClockState::kDrift];
  const std::vector<GnssRow> rows =
      LinearizeEpoch(context.config, context.mount, point, epoch.measurements, residuals);
  const auto count = static_cast<Index>(rows.size());
  FrameEpochRows result;
  result.frame.setZero(count, 15);
  result.clock.setZero(count, 6);
  result.lever_arm.setZero(count, 3);
  result.residual.setZero(count);
  result.information.assign(rows.size(), 1);
  result.contradicted.assign(rows.size(), false);
  for (Index i = 0; i < count; ++i) {
    const GnssRow& row = rows[static_cast<std::size_t>(i)];
    if (!epoch.used.empty() && !epoch.used[static_cast<std::size_t>(i)]) {
      continue;
    }
    RobustResidual residual{row.residual / row.deviation, 1};
    result.information[static_cast<std::size_t>(i)] = row.information;
    result.contradicted[static_cast<std::size_t>(i)] = row.contradicted;
    if (robust) {
      residual = Robustify(context.config.robust_kernel, context.config.robust_scale_sigma, residual.value);
      residual.value *= std::sqrt(row.information);
      residual.slope *= std::sqrt(row.information);
    }
    result.residual[i] = residual.value;
    result.frame.row(i).noalias() = residual.slope / row.deviation * (row.jacobian * carry);
    result.clock.row(i) = residual.slope / row.deviation * row.ClockJacobian();
    result.clock(i, ClockState::kDrift) += dt_s * result.clock(i, ClockState::kClock);
    result.lever_arm.row(i) = residual.slope / row.deviation * row.lever_arm;
  }
  return result;
}

bool GnssEpochFactor::Evaluate(const double* const* parameters, double* residual,
                               double* const* tangent_jacobians) const {
  GnssResiduals ignored;
  const Eigen::Map<const Vector6d> clock(parameters[2]);
  const FrameEpochRows rows = LinearizeFrameEpoch(*context_, *epoch_, dt_s_, UnpackNavState(parameters[0]),
                                                  UnpackBias(parameters[1]), clock, true, &ignored);
  CHECK_EQ(rows.residual.size(), rows_);
  Eigen::Map<Eigen::VectorXd>(residual, rows_) = rows.residual;
  if (tangent_jacobians == nullptr) {
    return true;
  }
  if (tangent_jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor>>(tangent_jacobians[0], rows_, 9) =
        rows.frame.leftCols<9>();
  }
  using RowMatrixX6 = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;
  if (tangent_jacobians[1] != nullptr) {
    Eigen::Map<RowMatrixX6>(tangent_jacobians[1], rows_, 6) = rows.frame.rightCols<6>();
  }
  if (tangent_jacobians[2] != nullptr) {
    Eigen::Map<RowMatrixX6>(tangent_jacobians[2], rows_, 6) = rows.clock;
  }
  if (sees_calibration() && tangent_jacobians[3] != nullptr) {
    PutLeverArm(*layout_, rows.lever_arm, tangent_jacobians[3]);
  }
  return true;
}

ClockStep::ClockStep(const GnssConfig& config, double dt_s, bool anew) {
  const ClockTransition transition = PropagateClock(config, dt_s);
  phi = transition.phi;
  Matrix6d q = transition.q;
  // A walk that is switched off is stiff, not singular.
  constexpr double kFloor = 1e-8;
  q.diagonal().array() += kFloor;
  if (anew) {
    q(ClockState::kClock, ClockState::kClock) += kFreshClockStdM * kFreshClockStdM;
  }
  const Eigen::LLT<Matrix6d> factor(q);
  root = factor.matrixL().solve(Matrix6d::Identity());
}

bool ClockFactor::Evaluate(const double* const* parameters, double* residual,
                           double* const* tangent_jacobians) const {
  const Eigen::Map<const Vector6d> first(parameters[0]);
  const Eigen::Map<const Vector6d> second(parameters[1]);
  Eigen::Map<Vector6d>{residual} = step_.root * (second - step_.phi * first);
  using RowMatrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  if (tangent_jacobians != nullptr && tangent_jacobians[0] != nullptr) {
    Eigen::Map<RowMatrix6>{tangent_jacobians[0]} = -step_.root * step_.phi;
  }
  if (tangent_jacobians != nullptr && tangent_jacobians[1] != nullptr) {
    Eigen::Map<RowMatrix6>{tangent_jacobians[1]} = step_.root;
  }
  return true;
}

}  // namespace alidade
