#include "core/gnss_config.h"

#include <string_view>

namespace alidade {

void GnssCorrectionOptions::Describe(ConfigVisitor& visitor) {
  visitor.Text({"systems", "-", "RINEX letters of the constellations in use, of GECJR"}, &systems);
  visitor.Enumeration(
      {"ionosphere", "-",
       "broadcast: GPS's Klobuchar model, else BeiDou's; free: the ionosphere-free pair of two bands; "
       "none"},
      &ionosphere,
      {{"none", IonosphereMode::kNone},
       {"broadcast", IonosphereMode::kBroadcast},
       {"free", IonosphereMode::kFree}});
  visitor.Real({"elevation_mask_deg", "deg", "below, multipath and atmosphere dominate"}, &elevation_mask_deg,
               0, 60);
  visitor.Real({"min_cn0_dbhz", "dB-Hz", "below, receivers report noise; a signal without C/N0 passes"},
               &min_cn0_dbhz, 0, 60);
  visitor.Real(
      {"pseudorange_std_m", "m", "deviation at the zenith and 45 dB-Hz; multipath of a good antenna"},
      &pseudorange_std_m, 0.01, 100);
  visitor.Real(
      {"range_rate_std_mps", "m/s", "deviation at the zenith and 45 dB-Hz; half a cycle per second times L1"},
      &range_rate_std_mps, 1e-4, 10);
  visitor.Real(
      {"glonass_factor", "-", "on both deviations for GLONASS: its channels are biased against each other"},
      &glonass_factor, 1, 100);
  visitor.Real(
      {"model_std_scale", "-",
       "on the deviations of orbit, clock, group delay and atmosphere; 0: the corrections are exact, "
       "as in a simulation"},
      &model_std_scale, 0, 100);
}

Status GnssCorrectionOptions::Validate() const {
  for (const char letter : systems) {
    if (std::string_view("GECJR").find(letter) == std::string_view::npos) {
      return Status::Config(std::string("systems: found '") + letter + "', expected letters of GECJR");
    }
  }
  return Status::Ok();
}

namespace {

void DescribeRobustness(GnssConfig* config, ConfigVisitor& visitor) {
  visitor.Boolean({"pseudorange", "-", "use code ranges: position"}, &config->pseudorange);
  visitor.Boolean({"doppler", "-", "use range rates: velocity, and heading while moving"}, &config->doppler);
  visitor.Real({"gate_probability", "-",
                "a satellite is used if its innovation lies in this chi-square quantile; 1 opens the gate"},
               &config->gate_probability, 0.5, 1.0);
  visitor.Real({"max_gated_share", "-",
                "when the gate refuses more of an epoch, the state is suspect and not the satellites: all "
                "are used, down-weighted to the gate"},
               &config->max_gated_share, 0, 1);
  visitor.Enumeration(
      {"robust_kernel", "-", "down-weights what the gate lets pass"}, &config->robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real({"robust_scale_sigma", "sigma", "whitened residual at which the kernel sets in"},
               &config->robust_scale_sigma, 0.1, 1e3);
}

void DescribeClock(GnssConfig* config, ConfigVisitor& visitor) {
  visitor.Real({"clock_walk_m_sqrts", "m/sqrt(s)",
                "white frequency noise of the receiver's oscillator; TCXO: 0.01 to 0.1"},
               &config->clock_walk_m_sqrts, 0, 1e6);
  visitor.Real({"drift_walk_mps_sqrts", "m/s/sqrt(s)", "walk of its frequency; TCXO: 0.01 to 0.1"},
               &config->drift_walk_mps_sqrts, 0, 1e6);
  visitor.Real({"inter_system_walk_m_sqrts", "m/sqrt(s)",
                "walk of the clock bias between systems; large: a clock a system, as in GVINS"},
               &config->inter_system_walk_m_sqrts, 0, 1e6);
  visitor.Real({"inter_system_std_m", "m", "of the biases between systems before they are seen"},
               &config->inter_system_std_m, 0.1, 1e6);
  visitor.Real({"clock_jump_m", "m",
                "a common step of most pseudoranges beyond this and six deviations is a jump of the clock, "
                "not of the receiver; a millisecond is 299 792 m"},
               &config->clock_jump_m, 1, 1e6);
}

void DescribeAlignment(GnssConfig* config, ConfigVisitor& visitor) {
  visitor.Integer({"align_min_epochs", "-", "GNSS epochs that the alignment needs"},
                  &config->align_min_epochs, 2, 1000);
  visitor.Integer({"align_min_satellites", "-",
                   "an epoch with fewer satellites is not used for the alignment; GVINS asks for 10"},
                  &config->align_min_satellites, 1, 60);
  visitor.Real({"align_window_s", "s", "older epochs are left out: odometry drifts"}, &config->align_window_s,
               1, 1000);
  visitor.Real(
      {"align_max_yaw_std_rad", "rad", "aligned once the yaw between local world and ENU is known this well"},
      &config->align_max_yaw_std_rad, 1e-3, 1);
  visitor.Real({"align_inflation", "-",
                "on the alignment's deviations: its epochs share atmosphere, multipath and odometry drift"},
               &config->align_inflation, 1, 100);
  visitor.Boolean({"estimate_time_offset", "-",
                   "estimate the offset between IMU and GNSS time during the alignment; else the sensor's "
                   "sheet is trusted"},
                  &config->estimate_time_offset);
  visitor.Real({"max_time_offset_s", "s", "bound of that estimate, around the sheet's value"},
               &config->max_time_offset_s, 1e-3, 1);
  visitor.Real({"max_interpolation_s", "s",
                "smoother: an epoch this near after a frame hangs on it by IMU; else it gets a state of its "
                "own"},
               &config->max_interpolation_s, 0, 10);
}

}  // namespace

void GnssConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean({"enabled", "-", "tightly coupled raw GNSS, where the sequence has it"}, &enabled);
  corrections.Describe(visitor);
  DescribeRobustness(this, visitor);
  DescribeClock(this, visitor);
  DescribeAlignment(this, visitor);
}

}  // namespace alidade
