#include "core/calibration_config.h"

namespace alidade {

void CalibrationConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"extrinsics", "-", "estimate the camera's pose on the body; needs rotation about two axes"},
      &extrinsics);
  visitor.Boolean({"time_offset", "-", "estimate the camera's time offset; needs motion that is not uniform"},
                  &time_offset);
  visitor.Boolean(
      {"line_delay", "-",
       "estimate the time from one row of a rolling shutter to the next; needs turns of the camera"},
      &line_delay);
  visitor.Boolean({"intrinsics", "-", "estimate focal lengths, principal point and lens coefficients"},
                  &intrinsics);
  visitor.Boolean({"watch", "-",
                   "test the given camera while none of it is estimated (extrinsics, time offset, focal "
                   "lengths, principal point), the lever arm of GNSS or of a position sensor, and their "
                   "positions against vision and IMU; what does not hold makes the status degraded"},
                  &watch);
  visitor.Real({"rotation_std_rad", "rad",
                "prior standard deviation of the given rotation of T_BC, each axis; 2 degrees"},
               &rotation_std_rad, 1e-6, 0.5);
  visitor.Real(
      {"translation_std_m", "m", "prior standard deviation of the given position of T_BC, each axis"},
      &translation_std_m, 1e-6, 1);
  visitor.Real({"time_offset_std_s", "s", "prior standard deviation of the given time offset"},
               &time_offset_std_s, 1e-7, 0.1);
  visitor.Real(
      {"line_delay_std_s", "s", "prior standard deviation of the given time from one row to the next"},
      &line_delay_std_s, 1e-9, 1e-3);
  visitor.Real({"focal_std_px", "px", "prior standard deviation of each focal length"}, &focal_std_px, 1e-4,
               1000);
  visitor.Real({"center_std_px", "px", "prior standard deviation of each coordinate of the principal point"},
               &center_std_px, 1e-4, 1000);
  visitor.Real(
      {"distortion_std", "-", "prior standard deviation of each lens coefficient; 0 keeps them fixed"},
      &distortion_std, 0, 1);
}

}  // namespace alidade
