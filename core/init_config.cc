#include "core/init_config.h"

namespace alidade {

void InitConfig::Describe(ConfigVisitor& visitor) {
  visitor.Enumeration(
      {"method", "-",
       "truth needs ground truth with velocity and biases; auto uses static at rest, else dynamic"},
      &method,
      {{"truth", InitMethod::kTruth},
       {"static", InitMethod::kStatic},
       {"dynamic", InitMethod::kDynamic},
       {"auto", InitMethod::kAuto}});
  visitor.Real({"tilt_std_rad", "rad", "standard deviation of the prior of roll and pitch"}, &tilt_std_rad,
               1e-6, 1);
  visitor.Real({"yaw_std_rad", "rad",
                "standard deviation of the prior of yaw; yaw is unobservable, so it remains in every later "
                "covariance"},
               &yaw_std_rad, 1e-6, 4);
  visitor.Real({"position_std_m", "m", "standard deviation of the prior of position; unobservable like yaw"},
               &position_std_m, 1e-6, 100);
  visitor.Real({"velocity_std_mps", "m/s", "standard deviation of the prior of velocity"}, &velocity_std_mps,
               1e-6, 100);
  visitor.Real({"gyro_bias_std_radps", "rad/s", "standard deviation of the prior of the gyroscope bias"},
               &gyro_bias_std_radps, 1e-7, 1);
  visitor.Real({"accel_bias_std_mps2", "m/s^2", "standard deviation of the prior of the accelerometer bias"},
               &accel_bias_std_mps2, 1e-6, 5);
  visitor.Boolean({"perturb_truth", "-",
                   "method truth: draw the start from the prior; otherwise the first NEES would be zero"},
                  &perturb_truth);
  visitor.Real(
      {"static_window_s", "s", "duration of rest from which gravity and gyroscope bias are estimated"},
      &static_window_s, 0.1, 60);
  visitor.Real({"static_max_gyro_std_radps", "rad/s", "larger values are classified as motion"},
               &static_max_gyro_std_radps, 1e-5, 1);
  visitor.Real({"static_max_accel_std_mps2", "m/s^2", "larger values are classified as motion"},
               &static_max_accel_std_mps2, 1e-4, 10);
  visitor.Real(
      {"static_max_parallax_px", "px",
       "mean track motion over the window; larger values are classified as motion at constant velocity"},
      &static_max_parallax_px, 0.01, 100);
  visitor.Real({"dynamic_window_s", "s", "window of data of the dynamic initialisation"}, &dynamic_window_s,
               0.5, 20);
  visitor.Integer({"dynamic_min_frames", "-",
                   "smallest number of frames; fewer do not determine velocity, gravity and scale"},
                  &dynamic_min_frames, 4, 100);
  visitor.Real({"dynamic_min_parallax_px", "px",
                "smallest mean track motion over the window; with less the scale is unobservable"},
               &dynamic_min_parallax_px, 1, 500);
  visitor.Real(
      {"max_wait_s", "s", "without an initial state after this time the run ends and reports the reason"},
      &max_wait_s, 1, 1e5);
}

}  // namespace alidade
