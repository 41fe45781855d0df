#include "eval/simulation/sim_fix_config.h"

namespace alidade {

void SimFixConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"rate_hz", "Hz", "of position fixes; 0: none"}, &rate_hz, 0, 1000);
  visitor.Real({"std_m", "m", "white noise towards east and north; RTK: 0.02, differential: 1"}, &std_m, 1e-4,
               1000);
  visitor.Real({"up_factor", "-", "times that deviation upwards"}, &up_factor, 0.1, 10);
  visitor.Vector3({"lever_arm_m", "m", "measured point in the body frame"}, &lever_arm_m, -100, 100);
  visitor.Real({"time_offset_s", "s", "t_imu = t_fix + offset; it is in the written calibration"},
               &time_offset_s, -1, 1);
  visitor.Boolean(
      {"own_frame", "-",
       "fixes stand in a frame of their own, without an anchor; else in the ENU frame of the gnss "
       "section's anchor"},
      &own_frame);
  visitor.Real({"frame_yaw_rad", "rad", "turn of the world into that frame"}, &frame_yaw_rad, -4, 4);
  visitor.Vector3({"frame_shift_m", "m", "then its shift"}, &frame_shift_m, -1e6, 1e6);
  visitor.Real({"wrong_rate", "-", "share of the fixes that are displaced horizontally, one by one"},
               &wrong_rate, 0, 1);
  visitor.Real({"wrong_min_m", "m", "by at least this; it is not in the written covariance"}, &wrong_min_m, 0,
               1e5);
  visitor.Real({"wrong_max_m", "m", "and at most this"}, &wrong_max_m, 0, 1e5);
  visitor.Real({"outage_start_s", "s", "when fixes stop; negative: never"}, &outage_start_s, -1, 1e6);
  visitor.Real({"outage_s", "s", "for how long"}, &outage_s, 0, 1e6);
}

Status SimFixConfig::Validate() const {
  if (!own_frame && (frame_yaw_rad != 0 || !frame_shift_m.isZero(0))) {
    return Status::Config(
        "fix.frame_yaw_rad: turn and shift of a frame of its own, expected fix.own_frame: true, or none of "
        "them");
  }
  return wrong_min_m <= wrong_max_m
             ? Status::Ok()
             : Status::Config("fix.wrong_min_m: found more than fix.wrong_max_m, expected at most that");
}

}  // namespace alidade
