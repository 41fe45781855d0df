#include "core/smoother_config.h"

#include "core/error_convention_config.h"

namespace alidade {

void SmootherConfig::Describe(ConfigVisitor& visitor) {
  DescribeErrorConvention(visitor, "error convention of the manifolds", &error);
  visitor.Enumeration(
      {"landmark", "-", "inverse_depth: explicit in the first frame; pose_only: solved inside the residual"},
      &landmark,
      {{"pose_only", SmootherLandmark::kPoseOnly}, {"inverse_depth", SmootherLandmark::kInverseDepth}});
  visitor.Integer({"window", "-", "number of frames besides the newest"}, &window, 3, 100);
  visitor.Integer(
      {"max_iterations", "-", "largest number of solver iterations; bounds the time reproducibly"},
      &max_iterations, 1, 100);
  visitor.Enumeration({"frames", "-", "which frames stay in the window"}, &frames,
                      {{"keyframes", FramePolicy::kKeyframes}, {"every_frame", FramePolicy::kEveryFrame}});
  visitor.Real({"keyframe_parallax_px", "px",
                "mean parallax to the last keyframe at which a frame becomes a keyframe"},
               &keyframe_parallax_px, 0, 500);
  visitor.Integer({"keyframe_min_tracked", "-",
                   "a frame that shares fewer tracks with the last keyframe becomes a keyframe"},
                  &keyframe_min_tracked, 0, 1000);
  visitor.Integer({"max_landmarks", "-", "largest number of landmarks in the window, longest tracks first"},
                  &max_landmarks, 10, 5000);
  visitor.Enumeration(
      {"parallax_gate", "-",
       "depth at which a track's baselines must show parallax; own: the track's, and where few have any the "
       "others enter at an assumed one; typical: the window's, and the others wait, except at rest"},
      &parallax_gate, {{"own", ParallaxGate::kOwn}, {"typical", ParallaxGate::kTypical}});
  visitor.Integer({"slam_features", "-",
                   "largest number of SLAM features: landmarks in the prior, whose information outlives the "
                   "window; 0: none"},
                  &slam_features, 0, 500);
  visitor.Boolean({"scale_volume", "-",
                   "take the scale of the start at the mode of its own density, not of the joint one, which "
                   "shrinks the window where the start's velocity is not known"},
                  &scale_volume);
  visitor.Boolean({"first_estimates", "-",
                   "evaluate Jacobians of frames in the prior where the prior was linearised: with so3xrn "
                   "yaw then stays unobservable"},
                  &first_estimates);
}

}  // namespace alidade
