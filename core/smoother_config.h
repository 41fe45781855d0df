#pragma once

#include "core/config_schema.h"
#include "core/error_convention.h"

namespace alidade {

enum class SmootherLandmark { kPoseOnly, kInverseDepth };
enum class ParallaxGate { kOwn, kTypical };
enum class FramePolicy { kKeyframes, kEveryFrame };

/// The sliding-window smoother.
struct SmootherConfig {
  ErrorConvention error = ErrorConvention::kRightInvariant;
  SmootherLandmark landmark = SmootherLandmark::kInverseDepth;
  int window = 10;
  int max_iterations = 8;
  FramePolicy frames = FramePolicy::kKeyframes;
  double keyframe_parallax_px = 10.0;
  int keyframe_min_tracked = 20;
  int max_landmarks = 150;
  ParallaxGate parallax_gate = ParallaxGate::kOwn;
  int slam_features = 0;
  bool scale_volume = false;
  bool first_estimates = false;
  /// Not a key. Solves go on to the minimum itself, undamped: for a comparison with another estimator.
  bool solve_to_rounding = false;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
