#include "eval/probe/probe_models.h"
#include "gnss/model/epoch_rows.h"

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

/// Prediction and its Jacobian over the chosen error of (theta, p, v), (bg, ba), clock and drift: the row
/// that the estimators linearise, of a measurement that reads zero.
Json Answer(const GnssCase& c, const SatelliteMeasurement& measurement, ErrorConvention convention) {
  GnssConfig config;
  config.corrections.elevation_mask_deg = 0;  // no direction is given: it stays at the horizon
  config.pseudorange = !measurement.range_rate_mps;
  config.doppler = !config.pseudorange;
  GnssPoint point{c.nav, c.bias, c.omega_radps};
  point.clock[ClockState::kClock] = c.clock_m;
  point.clock[ClockState::kDrift] = c.drift_mps;
  GnssResiduals residuals;
  const GnssRow linearized = LinearizeEpoch(config, c.mount, point, {0, {measurement}, {}}, &residuals).at(0);
  const Vector6d clock = linearized.ClockJacobian();
  Eigen::Matrix<double, 1, 17> row;
  row << linearized.jacobian * ImuChartJacobian(convention, c.nav), clock[ClockState::kClock],
      clock[ClockState::kDrift];
  Json answer;
  answer["predicted"] = linearized.residual;
  answer["H"] = ToJson(row);
  return answer;
}

}  // namespace

Json PseudorangeAnswer(const Json& input, ErrorConvention convention) {
  const GnssCase c = ReadCase(input);
  SatelliteMeasurement measurement;
  measurement.state = c.satellite;
  measurement.ionosphere_m = Number(Member(input, "iono_m"), "iono_m");
  measurement.troposphere_m = Number(Member(input, "tropo_m"), "tropo_m");
  return Answer(c, measurement, convention);
}

Json DopplerAnswer(const Json& input, ErrorConvention convention) {
  const GnssCase c = ReadCase(input);
  const double wavelength = Number(Member(input, "wavelength"), "wavelength");
  if (!(wavelength > 0)) {
    throw CaseError{"wavelength: expected a positive length in metres"};
  }
  SatelliteMeasurement measurement;
  measurement.state = c.satellite;
  measurement.range_rate_mps = 0;
  Json answer = Answer(c, measurement, convention);
  answer["predicted_hz"] = -answer["predicted"].get<double>() / wavelength;
  return answer;
}

}  // namespace alidade::probe
