#include "core/fix_config.h"

namespace alidade {

void FixConfig::Describe(ConfigVisitor& visitor) {
  visitor.Boolean(
      {"enabled", "-",
       "use position fixes, loosely coupled; without any in the sequence a run is impaired (exit code 8)"},
      &enabled);
  visitor.Real({"std_scale", "-",
                "factor on the standard deviations that the sensor reports; receivers report too small ones "
                "near buildings"},
               &std_scale, 0.01, 1000);
  visitor.Real({"std_floor_m", "m",
                "standard deviation added in quadrature to each axis, for errors of lever arm and time tag "
                "that the reported covariance lacks"},
               &std_floor_m, 0, 100);
  visitor.Real({"gate_probability", "-",
                "a fix is used if its innovation lies in this chi-square quantile; 1 opens the gate"},
               &gate_probability, 0.5, 1.0);
  visitor.Integer({"max_refused_run", "-",
                   "when the gate refuses more fixes in a row, the state is suspect: the fixes are used, "
                   "down-weighted to the gate"},
                  &max_refused_run, 1, 100000);
  visitor.Enumeration(
      {"robust_kernel", "-", "robust kernel for measurements that pass the gate"}, &robust_kernel,
      {{"none", RobustKernel::kNone}, {"huber", RobustKernel::kHuber}, {"cauchy", RobustKernel::kCauchy}});
  visitor.Real({"robust_scale_sigma", "sigma", "whitened norm of the innovation at which the kernel sets in"},
               &robust_scale_sigma, 0.1, 1e3);
  visitor.Integer({"align_min_fixes", "-", "consistent fixes that the alignment needs"}, &align_min_fixes, 3,
                  1000);
  visitor.Real({"align_window_s", "s", "older fixes are left out: odometry drifts"}, &align_window_s, 1,
               1000);
  visitor.Real({"align_max_yaw_std_rad", "rad",
                "aligned once the yaw between the local world and the frame of the fixes is known this well"},
               &align_max_yaw_std_rad, 1e-3, 1);
  visitor.Real({"align_inflation", "-",
                "factor on the standard deviations of the alignment, because errors of fixes are correlated "
                "in time and odometry drifts"},
               &align_inflation, 1, 100);
  visitor.Real(
      {"max_interpolation_s", "s",
       "smoother: a fix this near after a frame is attached to it by IMU; else it gets a state of its own"},
      &max_interpolation_s, 0, 10);
}

}  // namespace alidade
