#include "eval/probe/probe_models.h"
#include "gnss/model/measurement_model.h"

namespace alidade::probe {
namespace {

/// What both models take: body in ENU at an anchor, receiver clock, one satellite at transmission.
struct GnssCase {
  AntennaMount mount;
  NavState nav;
  ImuBias bias;
  Eigen::Vector3d omega_radps;
  double clock_m = 0;
  double drift_mps = 0;
  SatelliteState satellite;
};

GnssCase ReadCase(const Json& input) {
  GnssCase c;
  const Eigen::Vector3d llh = Vector(Member(input, "anchor_llh_deg"), "anchor_llh_deg", 3);
  constexpr double kDegree = M_PI / 180;
  c.mount.enu = EnuFrame::At(ToEcef({llh.x() * kDegree, llh.y() * kDegree, llh.z()}));
  c.mount.p_BA = Vector(Member(input, "lever_arm"), "lever_arm", 3);
  const Json& state = Member(input, "state");
  c.nav.R_WB = Rotation(Member(state, "q_wxyz"), "state.q_wxyz");
  c.nav.p_WB = Vector(Member(state, "p"), "state.p", 3);
  c.nav.v_WB = Vector(Member(state, "v"), "state.v", 3);
  c.bias = {Vector(Member(state, "bg"), "state.bg", 3), Vector(Member(state, "ba"), "state.ba", 3)};
  c.omega_radps = Vector(Member(input, "omega"), "omega", 3);
  c.clock_m = Number(Member(input, "clock_m"), "clock_m");
  c.drift_mps = Number(Member(input, "drift_mps"), "drift_mps");
  const Json& satellite = Member(input, "satellite");
  c.satellite.position_E = Vector(Member(satellite, "p"), "satellite.p", 3);
  c.satellite.velocity_E = Vector(Member(satellite, "v"), "satellite.v", 3);
  c.satellite.clock_m = Number(Member(satellite, "clock_m"), "satellite.clock_m");
  c.satellite.drift_mps = Number(Member(satellite, "drift_mps"), "satellite.drift_mps");
  return c;
}

/// Prediction and its Jacobian over the chosen error of (theta, p, v), (bg, ba), clock and drift.
Json Answer(const GnssCase& c, double predicted, const GnssJacobian& jacobian, bool rate,
            ErrorConvention convention) {
  Eigen::Matrix<double, 1, 17> row;
  row << jacobian * ImuChartJacobian(convention, c.nav), rate ? 0.0 : 1.0, rate ? 1.0 : 0.0;
  Json answer;
  answer["predicted"] = predicted;
  answer["H"] = ToJson(row);
  return answer;
}

}  // namespace

Json PseudorangeAnswer(const Json& input, ErrorConvention convention) {
  const GnssCase c = ReadCase(input);
  const double correction = -c.satellite.clock_m + Number(Member(input, "iono_m"), "iono_m") +
                            Number(Member(input, "tropo_m"), "tropo_m");
  double predicted = 0;
  GnssJacobian jacobian;
  EvaluatePseudorange({0, c.satellite.position_E, correction}, c.mount, c.nav, c.clock_m, &predicted,
                      &jacobian);
  return Answer(c, predicted, jacobian, false, convention);
}

Json DopplerAnswer(const Json& input, ErrorConvention convention) {
  const GnssCase c = ReadCase(input);
  const double wavelength = Number(Member(input, "wavelength"), "wavelength");
  if (!(wavelength > 0)) {
    throw CaseError{"wavelength: expected a positive length in metres"};
  }
  double predicted = 0;
  GnssJacobian jacobian;
  EvaluateRangeRate({0, c.satellite}, c.mount, c.nav, c.bias, c.omega_radps, c.drift_mps, &predicted,
                    &jacobian);
  Json answer = Answer(c, predicted, jacobian, true, convention);
  answer["predicted_hz"] = -predicted / wavelength;
  return answer;
}

}  // namespace alidade::probe
