#include "core/imu_propagation.h"
#include "core/preintegration.h"
#include "eval/probe/probe_models.h"

namespace alidade::probe {

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

  const Matrix15d C_before = ImuChartJacobian(convention, nav);
  ImuTransition transition;
  PropagateImu(samples, bias, noise, gravity, &nav, &transition);
  const Matrix15d C_after_inverse = InverseImuChartJacobian(convention, nav);

  Json answer;
  answer["state"]["q_wxyz"] = QuaternionToJson(nav.R_WB);
  answer["state"]["p"] = VectorToJson(nav.p_WB);
  answer["state"]["v"] = VectorToJson(nav.v_WB);
  answer["state"]["bg"] = VectorToJson(bias.gyro);
  answer["state"]["ba"] = VectorToJson(bias.accel);
  answer["Phi"] = ToJson(C_after_inverse * transition.phi * C_before);
  answer["Q"] = ToJson(C_after_inverse * transition.q * C_after_inverse.transpose());
  return answer;
}

Json PreintegrationAnswer(const Json& input,
                          ErrorConvention /*convention: increments have their own error*/) {
  const ImuBias bias{Vector(Member(input, "bg"), "bg", 3), Vector(Member(input, "ba"), "ba", 3)};
  Preintegration preintegration(bias, Noise(input));
  preintegration.Add(ImuSamples(input));

  Json answer;
  answer["alpha"] = VectorToJson(preintegration.alpha());
  answer["beta"] = VectorToJson(preintegration.beta());
  answer["gamma_wxyz"] = QuaternionToJson(preintegration.gamma());
  answer["J15"] = ToJson(preintegration.jacobian());
  answer["cov15"] = ToJson(preintegration.covariance());
  return answer;
}

}  // namespace alidade::probe
