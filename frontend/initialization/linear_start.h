#pragma once

#include "core/navigation_state.h"
#include "core/status.h"
#include "frontend/initialization/dynamic_window.h"

namespace alidade {

/// A first guess of every state of the window, in a world whose z is up and whose origin is the first body
/// position.
struct LinearStart {
  std::vector<NavState> states;
  ImuBias bias;
  double free_gravity_mps2 = 0;  ///< |g| when its magnitude is not imposed: a check, noisy over short windows
};

/// Velocity and gravity in closed form (Martinelli 2014; Dong-Si and Mourikis 2012). In the first body frame,
/// with rotations R_k and increments alpha_k from the IMU less `bias`, the body is at p_k = v t + g t^2/2 +
/// alpha_k, and each ray must meet its landmark f: B_k^T (f - p_k - R_k p_BC) = 0, B_k (3x2) across the ray.
/// Landmarks are eliminated by Householder; what is left is linear in (v, g), solved under |g| = gravity_mps2
/// (global minimiser by the secular equation). Rows are weighted by depth x angular deviation and by Cauchy
/// weights of the last round. The accelerometer bias is NOT solved for: rays of unknown depth are happiest
/// when everything shrinks, and a free bias lets it. Error (kDiverged): fewer than eight usable tracks, or a
/// singular system.
Result<LinearStart> SolveLinearStart(const DynamicWindow& window,
                                     const std::vector<Preintegration>& preintegrations, const ImuBias& bias,
                                     const std::vector<bool>& inlier, const Pose& T_BC, double gravity_mps2);

}  // namespace alidade
