#include "core/gnss_config.h"

#include <string_view>

namespace alidade {

void GnssCorrectionOptions::Describe(ConfigVisitor& visitor) {
  visitor.Text({"systems", "-", "constellations in use, by their RINEX letters: any of GECJR"}, &systems);
  visitor.Enumeration({"ionosphere", "-",
                       "broadcast: Klobuchar model with GPS parameters, else BeiDou's; free: ionosphere-free "
                       "pair of two bands; none"},
                      &ionosphere,
                      {{"none", IonosphereMode::kNone},
                       {"broadcast", IonosphereMode::kBroadcast},
                       {"free", IonosphereMode::kFree}});
  visitor.Real(
      {"elevation_mask_deg", "deg", "satellites below are not used; multipath and atmosphere dominate there"},
      &elevation_mask_deg, 0, 60);
  visitor.Real({"min_cn0_dbhz", "dB-Hz", "weaker signals are not used; a signal without C/N0 is used"},
               &min_cn0_dbhz, 0, 60);
  visitor.Real({"pseudorange_std_m", "m",
                "standard deviation at the zenith and 45 dB-Hz, including multipath of a good antenna"},
               &pseudorange_std_m, 0.01, 100);
  visitor.Real(
      {"range_rate_std_mps", "m/s",
       "standard deviation at the zenith and 45 dB-Hz; half a cycle per second times the L1 wavelength"},
      &range_rate_std_mps, 1e-4, 10);
  visitor.Real({"glonass_factor", "-",
                "factor on both standard deviations for GLONASS, whose channels have different biases"},
               &glonass_factor, 1, 100);
  visitor.Real({"model_std_scale", "-",
                "factor on the standard deviations of orbit, clock, group delay and atmosphere; 0: exact "
                "corrections, as in a simulation"},
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
  visitor.Boolean({"pseudorange", "-", "use pseudoranges; they determine position"}, &config->pseudorange);
  visitor.Boolean({"doppler", "-", "use range rates; they determine velocity, and heading in motion"},
                  &config->doppler);
  visitor.Real(
      {"gate_probability", "-",
       "chi-square gate: a satellite is used if its NIS is below this quantile; 1 disables the gate"},
      &config->gate_probability, 0.5, 1.0);
  visitor.Real({"max_gated_share", "-",
                "consensus gate: when the gate rejects a larger share of an epoch, the state is suspect and "
                "all satellites are used, with weights reduced to the gate"},
               &config->max_gated_share, 0, 1);
  visitor.Enumeration(
      {"robust_kernel", "-", "robust kernel for measurements that pass the gate"}, &config->robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real({"robust_scale_sigma", "sigma", "whitened residual above which the kernel reduces the weight"},
               &config->robust_scale_sigma, 0.1, 1e3);
  visitor.Boolean(
      {"lasting_errors", "-",
       "measure size and duration of the errors of pseudoranges, such as multipath, and weigh "
       "pseudoranges by them; the gate leaves out the state's uncertainty for satellites that the "
       "single-point solution refuses; false: white noise as stated"},
      &config->lasting_errors);
}

void DescribeClock(GnssConfig* config, ConfigVisitor& visitor) {
  visitor.Real({"clock_walk_m_sqrts", "m/sqrt(s)",
                "white frequency noise of the receiver's oscillator; TCXO: 0.01 to 0.1"},
               &config->clock_walk_m_sqrts, 0, 1e6);
  visitor.Real({"drift_walk_mps_sqrts", "m/s/sqrt(s)", "random walk of its frequency; TCXO: 0.01 to 0.1"},
               &config->drift_walk_mps_sqrts, 0, 1e6);
  visitor.Real(
      {"inter_system_walk_m_sqrts", "m/sqrt(s)",
       "random walk of the inter-system clock biases; a large value gives one clock a system, as in GVINS"},
      &config->inter_system_walk_m_sqrts, 0, 1e6);
  visitor.Real({"inter_system_std_m", "m", "prior standard deviation of the inter-system biases"},
               &config->inter_system_std_m, 0.1, 1e6);
  visitor.Real({"clock_jump_m", "m",
                "a common step of most pseudoranges beyond this and six standard deviations is a clock jump; "
                "a millisecond is 299 792 m"},
               &config->clock_jump_m, 1, 1e6);
}

void DescribeAlignment(GnssConfig* config, ConfigVisitor& visitor) {
  visitor.Integer({"align_min_epochs", "-", "smallest number of GNSS epochs for the alignment"},
                  &config->align_min_epochs, 2, 1000);
  visitor.Integer({"align_min_satellites", "-",
                   "epochs with fewer satellites are not used for the alignment; GVINS requires 10"},
                  &config->align_min_satellites, 1, 60);
  visitor.Real(
      {"align_window_s", "s", "older epochs are not used for the alignment, because odometry drifts"},
      &config->align_window_s, 1, 1000);
  visitor.Real({"align_max_yaw_std_rad", "rad",
                "largest standard deviation of the yaw between local world and ENU at which the alignment is "
                "accepted"},
               &config->align_max_yaw_std_rad, 1e-3, 1);
  visitor.Real({"align_inflation", "-",
                "factor on the standard deviations of the alignment, whose epochs share atmosphere, "
                "multipath and odometry drift"},
               &config->align_inflation, 1, 100);
  visitor.Boolean({"estimate_time_offset", "-",
                   "estimate the offset between IMU and GNSS time during the alignment; otherwise the sensor "
                   "sheet's offset is used"},
                  &config->estimate_time_offset);
  visitor.Real({"max_time_offset_s", "s", "largest difference of that estimate from the sheet's offset"},
               &config->max_time_offset_s, 1e-3, 1);
  visitor.Real({"max_interpolation_s", "s",
                "smoother: an epoch within this time after a frame is linked to it by IMU; a later epoch "
                "gets its own state"},
               &config->max_interpolation_s, 0, 10);
}

}  // namespace

void GnssConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"enabled", "-",
       "use raw GNSS, tightly coupled; without any in the sequence a run is impaired (exit code 8)"},
      &enabled);
  corrections.Describe(visitor);
  DescribeRobustness(this, visitor);
  DescribeClock(this, visitor);
  DescribeAlignment(this, visitor);
}

}  // namespace alidade
