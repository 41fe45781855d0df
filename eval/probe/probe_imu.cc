#include <array>

#include "core/imu_propagation.h"
#include "core/preintegration.h"
#include "eval/probe/probe_models.h"

namespace alidade::probe {
namespace {

/// From the order (theta, alpha, beta, bg, ba) to (alpha, beta, theta, bg, ba).
Matrix15d RotationLast(const Matrix15d& m) {
  std::array<int, 15> order;
  for (int i = 0; i < 15; ++i) {
    order[static_cast<size_t>(i)] = i < 9 ? (i + 3) % 9 : i;
  }
  return m(order, order);
}

}  // namespace

Json ImuPropagationAnswer(const Json& input, ErrorConvention convention) {
  const Json& state = Member(input, "state");
  NavState nav;
  nav.R_WB = Rotation(Member(state, "q_wxyz"), "state.q_wxyz");
  nav.p_WB = Vector(Member(state, "p"), "state.p", 3);
  nav.v_WB = Vector(Member(state, "v"), "state.v", 3);
  const ImuBias bias{Vector(Member(state, "bg"), "state.bg", 3), Vector(Member(state, "ba"), "state.ba", 3)};
  const Eigen::Vector3d gravity = Vector(Member(input, "gravity"), "gravity", 3);
  const ImuNoise noise = Noise(input);
  const std::vector<ImuSample> samples = ImuSamples(input);

  Preintegration preintegration(bias, noise);
  preintegration.Add(samples);
  const Matrix15d C_before = ImuChartJacobian(convention, nav);
  ImuTransition transition;
  if (const Status status = PropagateState(preintegration, gravity, &nav, &transition); !status.ok()) {
    throw CaseError{status.message()};
  }
  const Matrix15d C_after_inverse = InverseImuChartJacobian(convention, nav);

  Json answer;
  answer["state"]["q_wxyz"] = QuaternionToJson(nav.R_WB);
  answer["state"]["p"] = VectorToJson(nav.p_WB);
  answer["state"]["v"] = VectorToJson(nav.v_WB);
  answer["state"]["bg"] = VectorToJson(bias.gyro);
  answer["state"]["ba"] = VectorToJson(bias.accel);
  answer["Phi"] = ToJson(C_after_inverse * transition.phi * C_before);
  answer["Q"] = ToJson(C_after_inverse * transition.q() * C_after_inverse.transpose());
  return answer;
}

Json PreintegrationAnswer(const Json& input,
                          ErrorConvention /*convention: increments have their own error*/) {
  const ImuBias bias{Vector(Member(input, "bg"), "bg", 3), Vector(Member(input, "ba"), "ba", 3)};
  Preintegration preintegration(bias, Noise(input));
  preintegration.Add(ImuSamples(input));

  // The increments' error over that at the start is the transition of a state at the origin without gravity.
  Matrix15d jacobian;
  static_cast<void>(CarryState(preintegration, NavState(), bias, Eigen::Vector3d::Zero(), &jacobian));

  Json answer;
  answer["alpha"] = VectorToJson(preintegration.motion().alpha);
  answer["beta"] = VectorToJson(preintegration.motion().beta);
  answer["gamma_wxyz"] = QuaternionToJson(preintegration.motion().gamma);
  answer["J15"] = ToJson(RotationLast(jacobian));
  answer["cov15"] = ToJson(RotationLast(preintegration.covariance()));
  return answer;
}

}  // namespace alidade::probe
