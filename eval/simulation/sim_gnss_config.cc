#include "eval/simulation/sim_gnss_config.h"

#include <string_view>

namespace alidade {
namespace {

void DescribeErrors(SimGnssConfig* c, ConfigVisitor& visitor) {
  visitor.Real({"pseudorange_noise_m", "m",
                "white noise at the zenith; grows towards the horizon as the estimators' weights assume"},
               &c->pseudorange_noise_m, 0, 100);
  visitor.Real({"range_rate_noise_mps", "m/s", "the same for range rates"}, &c->range_rate_noise_mps, 0, 10);
  visitor.Boolean({"ionosphere", "-", "delay by the broadcast Klobuchar parameters"}, &c->ionosphere);
  visitor.Boolean({"troposphere", "-", "delay by Saastamoinen and Niell"}, &c->troposphere);
  visitor.Real({"ionosphere_error", "-",
                "standard deviation of the relative error of the broadcast delay, drawn once a run"},
               &c->ionosphere_error, 0, 1);
  visitor.Real({"clock_bias_m", "m", "standard deviation of the receiver clock at the start"},
               &c->clock_bias_m, 0, 1e6);
  visitor.Real({"clock_drift_mps", "m/s",
                "standard deviation of the clock drift at the start; TCXO: 0.1 ppm is 30 m/s"},
               &c->clock_drift_mps, 0, 1e4);
  visitor.Real({"clock_walk_m_sqrts", "m/sqrt(s)", "white frequency noise of the clock"},
               &c->clock_walk_m_sqrts, 0, 100);
  visitor.Real({"drift_walk_mps_sqrts", "m/s/sqrt(s)", "random walk of the clock frequency"},
               &c->drift_walk_mps_sqrts, 0, 100);
  visitor.Real({"inter_system_bias_m", "m", "standard deviation of the constant bias of each further system"},
               &c->inter_system_bias_m, 0, 1e4);
  visitor.Real({"clock_jump_at_s", "s",
                "time at which the receiver clock is set back by a millisecond; negative: never"},
               &c->clock_jump_at_s, -1, 1e6);
}

void DescribeEnvironment(SimGnssConfig* c, ConfigVisitor& visitor) {
  visitor.Real({"multipath_m", "m", "standard deviation of a time-correlated code error of each satellite"},
               &c->multipath_m, 0, 100);
  visitor.Real({"multipath_time_s", "s", "correlation time of multipath"}, &c->multipath_time_s, 0.1, 1e4);
  visitor.Real({"nlos_rate", "-", "share of satellites received only by reflection"}, &c->nlos_rate, 0, 1);
  visitor.Real({"nlos_min_m", "m", "smallest extra path of a reflection"}, &c->nlos_min_m, 0, 1e4);
  visitor.Real({"nlos_max_m", "m", "largest extra path of a reflection"}, &c->nlos_max_m, 0, 1e4);
  visitor.Real({"nlos_time_s", "s", "duration of a satellite's state, direct or reflected"}, &c->nlos_time_s,
               0.1, 1e5);
  visitor.Real({"outage_start_s", "s", "start of the outage; negative: never"}, &c->outage_start_s, -1, 1e6);
  visitor.Real({"outage_s", "s", "duration of the outage"}, &c->outage_s, 0, 1e6);
  visitor.Integer(
      {"outage_satellites", "-", "number of satellites that remain during the outage, the highest ones"},
      &c->outage_satellites, 0, 100);
}

}  // namespace

void SimGnssConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"rate_hz", "Hz", "rate of the receiver; 0: no GNSS"}, &rate_hz, 0, 100);
  visitor.Real({"anchor_latitude_deg", "deg", "latitude of the anchor; the world is the ENU frame there"},
               &anchor_latitude_deg, -90, 90);
  visitor.Real({"anchor_longitude_deg", "deg", "longitude of the anchor"}, &anchor_longitude_deg, -180, 180);
  visitor.Real({"anchor_height_m", "m", "height of the anchor above the ellipsoid"}, &anchor_height_m, -100,
               9000);
  visitor.Vector3({"lever_arm_m", "m", "antenna in the body frame"}, &lever_arm_m, -100, 100);
  visitor.Real({"time_offset_s", "s", "t_imu = t_GPST + offset; the written calibration contains it"},
               &time_offset_s, -1, 1);
  visitor.Text({"navigation_file", "-",
                "RINEX navigation file whose satellites are used; none: embedded synthetic constellations; "
                "relative to this file"},
               &navigation_file);
  visitor.Text({"systems", "-", "constellations, by their RINEX letters: any of GECR"}, &systems);
  visitor.Real({"elevation_mask_deg", "deg", "satellites below are not received"}, &elevation_mask_deg, 0,
               80);
  visitor.Boolean({"second_band", "-", "a second signal (L2, E5a, B3I, G2) with independent noise"},
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
