#include "smoother/truth/truth_terms.h"

#include "core/error_convention.h"
#include "core/imu_buffer.h"
#include "core/imu_propagation.h"
#include "core/imu_step.h"

namespace alidade {

std::optional<TruthLink> LinearizeLink(const ImuSample& from, const ImuSample& to, const TruthState& first,
                                       const TruthState& second, const TruthImu& imu) {
  Preintegration preintegration(first.bias, imu.noise);
  preintegration.Add(from, to);
  Matrix15d whitening;
  if (!preintegration.Whitening(&whitening)) {
    return std::nullopt;
  }
  TruthLink link;
  const PreintegrationModel model{&preintegration, imu.gravity_W};
  model.Evaluate(first.nav, first.bias, second.nav, second.bias, &link.residual, &link.of_first,
                 &link.of_second);
  // A factor acts on the mean over the step, as a bias of the other sign does. Neglected: its effect on what
  // the change within the step adds (core/imu_step.h).
  link.of_constants.setZero();
  const Vector6d mean = ParabolaMean(from, to, ImuBias());
  link.of_constants.block<9, kScales>(0, kScaleColumn) =
      -link.of_first.block<9, kScales>(0, 9) * mean.asDiagonal();
  const auto lower = whitening.triangularView<Eigen::Lower>();
  link.residual = (lower * link.residual).eval();
  link.of_first = (lower * link.of_first).eval();
  link.of_second = (lower * link.of_second).eval();
  link.of_constants = (lower * link.of_constants).eval();
  return link;
}

TruthPoseTerm LinearizePose(const Pose& T_TM, TimeNs stamp_ns, const ImuSample& from, const ImuSample& to,
                            const TruthState& state, const TruthConstants& constants, const TruthImu& imu) {
  const ImuSample here = Interpolate(from, to, stamp_ns);
  Preintegration preintegration(state.bias, imu.noise);
  if (stamp_ns > from.stamp_ns) {
    preintegration.Add(from, here);
  }
  Matrix15d transition;
  const NavState carried = CarryState(preintegration, state.nav, state.bias, imu.gravity_W, &transition);
  TruthPoseTerm term;
  Eigen::Matrix<double, 6, 9> of_carried;
  Eigen::Matrix<double, 6, kTruthConstants> of_constants;
  TruthPoseModel{T_TM}.Evaluate(carried, here.gyro - state.bias.gyro, constants, &term.residual, &of_carried,
                                &of_constants);
  term.of_constants << of_constants, Eigen::Matrix<double, 6, kScales>::Zero();
  term.of_state = of_carried * transition.topRows<9>();
  return term;
}

TruthState Retract(const TruthState& state, const Vector15d& error) {
  TruthState moved;
  moved.nav = Retract(ErrorConvention::kSo3xRn, state.nav, error.head<9>());
  moved.nav.R_WB = so3::Normalize(moved.nav.R_WB);  // many small steps add up
  moved.bias.gyro = state.bias.gyro + error.segment<3>(9);
  moved.bias.accel = state.bias.accel + error.segment<3>(12);
  return moved;
}

}  // namespace alidade
