#include "eval/simulation/sim_gnss_config.h"

#include <string_view>

namespace alidade {
namespace {

void DescribeErrors(SimGnssConfig* c, ConfigVisitor& visitor) {
  visitor.Real({"pseudorange_noise_m", "m",
                "white, at the zenith; grows towards the horizon as an estimator's weights assume"},
               &c->pseudorange_noise_m, 0, 100);
  visitor.Real({"range_rate_noise_mps", "m/s", "likewise, of Doppler"}, &c->range_rate_noise_mps, 0, 10);
  visitor.Boolean({"ionosphere", "-", "delay by the broadcast Klobuchar parameters"}, &c->ionosphere);
  visitor.Boolean({"troposphere", "-", "delay by Saastamoinen and Niell"}, &c->troposphere);
  visitor.Real(
      {"ionosphere_error", "-", "deviation of the true delay over the broadcast one less 1, one draw a run"},
      &c->ionosphere_error, 0, 1);
  visitor.Real({"clock_bias_m", "m", "deviation of the receiver clock at the start"}, &c->clock_bias_m, 0,
               1e6);
  visitor.Real({"clock_drift_mps", "m/s", "deviation of its drift at the start; TCXO: 0.1 ppm is 30 m/s"},
               &c->clock_drift_mps, 0, 1e4);
  visitor.Real({"clock_walk_m_sqrts", "m/sqrt(s)", "white frequency noise of the clock"},
               &c->clock_walk_m_sqrts, 0, 100);
  visitor.Real({"drift_walk_mps_sqrts", "m/s/sqrt(s)", "walk of its frequency"}, &c->drift_walk_mps_sqrts, 0,
               100);
  visitor.Real({"inter_system_bias_m", "m", "deviation of each further system's constant bias"},
               &c->inter_system_bias_m, 0, 1e4);
  visitor.Real(
      {"clock_jump_at_s", "s", "when the receiver clock is set back by a millisecond; negative: never"},
      &c->clock_jump_at_s, -1, 1e6);
}

void DescribeEnvironment(SimGnssConfig* c, ConfigVisitor& visitor) {
  visitor.Real({"multipath_m", "m", "deviation of a code error of each satellite that is correlated in time"},
               &c->multipath_m, 0, 100);
  visitor.Real({"multipath_time_s", "s", "its correlation time"}, &c->multipath_time_s, 0.1, 1e4);
  visitor.Real({"nlos_rate", "-", "share of the satellites that are seen by a reflection alone"},
               &c->nlos_rate, 0, 1);
  visitor.Real({"nlos_min_m", "m", "extra path of a reflection, at least"}, &c->nlos_min_m, 0, 1e4);
  visitor.Real({"nlos_max_m", "m", "and at most"}, &c->nlos_max_m, 0, 1e4);
  visitor.Real({"nlos_time_s", "s", "how long a satellite's state, direct or reflected, lasts"},
               &c->nlos_time_s, 0.1, 1e5);
  visitor.Real({"outage_start_s", "s", "when satellites are lost; negative: never"}, &c->outage_start_s, -1,
               1e6);
  visitor.Real({"outage_s", "s", "for how long"}, &c->outage_s, 0, 1e6);
  visitor.Integer({"outage_satellites", "-", "how many, the highest ones, are left in the outage"},
                  &c->outage_satellites, 0, 100);
}

}  // namespace

void SimGnssConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"rate_hz", "Hz", "of the receiver; 0: none"}, &rate_hz, 0, 100);
  visitor.Real({"anchor_latitude_deg", "deg", "the world is the ENU frame there"}, &anchor_latitude_deg, -90,
               90);
  visitor.Real({"anchor_longitude_deg", "deg", "of the anchor"}, &anchor_longitude_deg, -180, 180);
  visitor.Real({"anchor_height_m", "m", "of the anchor above the ellipsoid"}, &anchor_height_m, -100, 9000);
  visitor.Vector3({"lever_arm_m", "m", "antenna in the body frame"}, &lever_arm_m, -100, 100);
  visitor.Real({"time_offset_s", "s", "t_imu = t_GPST + offset; the written calibration knows it"},
               &time_offset_s, -1, 1);
  visitor.Text({"navigation_file", "-",
                "RINEX navigation file whose satellites are used; none: embedded constellations of made-up "
                "numbers; relative to this file"},
               &navigation_file);
  visitor.Text({"systems", "-", "RINEX letters of the constellations, of GECR"}, &systems);
  visitor.Real({"elevation_mask_deg", "deg", "lower satellites are not seen"}, &elevation_mask_deg, 0, 80);
  visitor.Boolean({"second_band", "-", "a second signal (L2, E5a, B3I, G2) with noise of its own"},
                  &second_band);
  DescribeErrors(this, visitor);
  DescribeEnvironment(this, visitor);
}

Status SimGnssConfig::Validate() const {
  for (const char letter : systems) {
    if (std::string_view("GECR").find(letter) == std::string_view::npos) {
      return Status::Config(std::string("gnss.systems: found '") + letter + "', expected letters of GECR");
    }
  }
  return nlos_min_m <= nlos_max_m
             ? Status::Ok()
             : Status::Config("gnss.nlos_min_m: found more than gnss.nlos_max_m, expected at most that");
}

}  // namespace alidade
