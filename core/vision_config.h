#pragma once

#include "core/config_schema.h"
#include "core/robust_kernel.h"

namespace alidade {

/// Which noise the image coordinates of a track have.
enum class PixelNoiseModel {
  kGiven,     ///< pixel_noise_px
  kAdaptive,  ///< never less, and more where the innovations require it (core/pixel_noise.h)
};

/// Which noise the gate of tracks takes.
enum class GateNoiseModel {
  kGiven,     ///< that of the weights
  kAdaptive,  ///< less, where most tracks show less (core/gate_noise.h)
};

/// What the gate of tracks refuses.
enum class GateUnit {
  kTrack,        ///< a track whole
  kObservation,  ///< of a refused track the observations that contradict the others, where that suffices
};

/// On which plane the observations of a track are (core/bearing_plane.h).
enum class PlaneChoice {
  kLens,        ///< that of the lens: CameraModel::plane
  kNormalized,  ///< z = 1; what lies beside or behind the camera is not seen
  kTangent,     ///< of the unit sphere, at each measured ray
};

/// Noise, gates and kernels of vision; shared by both back ends so that a comparison compares estimators, not
/// settings.
struct VisionConfig {
  double pixel_noise_px = 1.0;
  PixelNoiseModel noise = PixelNoiseModel::kGiven;
  bool noise_ratios = false;
  PlaneChoice observation_plane = PlaneChoice::kLens;
  bool rolling_shutter = true;
  double gate_probability = 0.99;
  GateNoiseModel gate_noise = GateNoiseModel::kGiven;
  GateUnit gate_unit = GateUnit::kTrack;
  double max_gated_share = 0.5;
  double max_relative_depth_deviation = 0.1;
  double min_depth_m = 0.1;
  double max_depth_m = 300.0;
  RobustKernel robust_kernel = RobustKernel::kHuber;
  double robust_scale_sigma = 2.0;
  // Standing still (core/rest_detector.h).
  bool rest_updates = true;
  double rest_window_s = 0.5;
  double rest_max_flow_px = 1.0;
  double rest_max_accel_std_mps2 = 1.0;
  double rest_velocity_std_mps = 0.02;
  double rest_rate_std_radps = 0.005;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
