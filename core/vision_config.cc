#include "core/vision_config.h"

namespace alidade {

void VisionConfig::Describe(ConfigVisitor& visitor) {
  visitor.Real({"pixel_noise_px", "px", "standard deviation of one image coordinate of a track"},
               &pixel_noise_px, 0.01, 100);
  visitor.Enumeration({"noise", "-",
                       "noise of the tracks: pixel_noise_px as given, or `adaptive`, which raises it slowly "
                       "while the innovations are larger than predicted"},
                      &noise, {{"given", PixelNoiseModel::kGiven}, {"adaptive", PixelNoiseModel::kAdaptive}});
  visitor.Boolean(
      {"noise_ratios", "-",
       "the noise of each observation is pixel_noise_px times its noise_ratio, from the front end or "
       "tracks.csv; false: all have the same noise"},
      &noise_ratios);
  visitor.Enumeration(
      {"observation_plane", "-",
       "plane of the visual residual: the normalised plane z = 1, the tangent plane of the unit "
       "sphere at each measured ray, or by `lens`: tangent where a spherical lens sees beyond 80 "
       "degrees off axis"},
      &observation_plane,
      {{"lens", PlaneChoice::kLens},
       {"normalized", PlaneChoice::kNormalized},
       {"tangent", PlaneChoice::kTangent}});
  visitor.Boolean({"rolling_shutter", "-",
                   "every observation has the time of its row, where the camera's sheet has a line delay or "
                   "calibration.line_delay estimates it; false: all rows are taken as exposed at once"},
                  &rolling_shutter);
  visitor.Real({"gate_probability", "-",
                "chi-square gate: a track is used if its NIS is below this quantile; 1 disables the gate"},
               &gate_probability, 0.5, 1.0);
  visitor.Enumeration({"gate_noise", "-",
                       "pixel noise of the gate: that of the weights, or `adaptive`, lowered to what most "
                       "tracks show, so that tracks which slide are refused"},
                      &gate_noise,
                      {{"given", GateNoiseModel::kGiven}, {"adaptive", GateNoiseModel::kAdaptive}});
  visitor.Enumeration({"gate_unit", "-",
                       "what the gate refuses: a track whole, or `observation`: of a track that it refuses, "
                       "the observations that contradict the others, where the rest then passes"},
                      &gate_unit, {{"track", GateUnit::kTrack}, {"observation", GateUnit::kObservation}});
  visitor.Real({"max_gated_share", "-",
                "consensus gate: when the gate rejects a larger share of the tracks, the state is suspect "
                "and all are used, with weights reduced to the gate"},
               &max_gated_share, 0, 1);
  visitor.Real({"max_relative_depth_deviation", "-",
                "parallax gate: largest relative standard deviation of the depth at which a track is used; "
                "above 0.05 the linearisation is poor"},
               &max_relative_depth_deviation, 1e-4, 10);
  visitor.Real({"min_depth_m", "m", "landmarks closer than this are rejected as mismatches"}, &min_depth_m,
               1e-3, 100);
  visitor.Real(
      {"max_depth_m", "m", "landmarks farther than this are rejected; they do not constrain translation"},
      &max_depth_m, 1, 1e5);
  visitor.Enumeration({"robust_kernel", "-", "robust kernel for measurements that pass the gate"},
                      &robust_kernel,
                      {{"none", RobustKernel::kNone},
                       {"huber", RobustKernel::kHuber},
                       {"cauchy", RobustKernel::kCauchy},
                       {"log_tail", RobustKernel::kLogTail}});
  visitor.Real({"robust_scale_sigma", "sigma",
                "norm of the whitened residual above which the kernel reduces the weight"},
               &robust_scale_sigma, 0.1, 1e3);
  visitor.Boolean(
      {"rest_updates", "-",
       "use zero velocity as a measurement at rest, where tracks without parallax do not constrain velocity"},
      &rest_updates);
  visitor.Real({"rest_window_s", "s", "duration of rest before it is detected"}, &rest_window_s, 0.1, 10);
  visitor.Real({"rest_max_flow_px", "px", "largest image flow over the window at rest"}, &rest_max_flow_px,
               0.01, 20);
  visitor.Real({"rest_max_accel_std_mps2", "m/s^2",
                "largest standard deviation of specific force at rest; running rotors vibrate"},
               &rest_max_accel_std_mps2, 1e-3, 20);
  visitor.Real({"rest_velocity_std_mps", "m/s", "standard deviation of the zero velocity at rest"},
               &rest_velocity_std_mps, 1e-5, 1);
  visitor.Real({"rest_rate_std_radps", "rad/s", "standard deviation of the zero angular rate at rest"},
               &rest_rate_std_radps, 1e-6, 1);
}

}  // namespace alidade
