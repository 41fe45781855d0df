#pragma once

#include <cstdint>
#include <memory>

#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// The analytic trajectory that a simulator configuration describes.
///
/// Position over the phase u (L, W, h = length, width, height; D = path length):
///   figure8   p = (L/2 sin u, W/2 sin 2u, h sin 3u)       Gerono's lemniscate, starts at the origin
///   ellipse   p = (L/2 cos u, W/2 sin u,  h sin 3u)
///   wander    p = (L/2 s_x(u), W/2 s_y(u), h s_z(u)),  s(u) as in eval/simulation/path_drift.h
///   hover     the same walk, level and in one direction: with a box of decimetres a hovering vehicle
///   rotation  p = 0
///   line      p = (D u / 2 pi, 0, 0)
///   spiral    p = (r cos u, r sin u, c u / 2 pi),  r = L/2 + w u / 2 pi;
///             w, c = spiral_widening_m, spiral_climb_m
/// wander, hover and rotation are drawn from the seed: paths of any length that never repeat. The others do
/// not depend on the seed.
///
/// The phase runs with the warped time tau(t) of eval/simulation/motion_time.h (rest, pauses, changes of
/// speed), scaled so that the whole sequence travels path_m; rotation has the root mean square yaw rate
/// rotation_rate_radps instead. The body (x forward, y left, z up) points along the tangent of figure8,
/// ellipse and spiral and along x on a line and in hover; in wander and rotation yaw (within 1.5 pi) and
/// pitch (within 0.3 rad) are sums like s of their own. Added are a wobble in roll, pitch and yaw and a yaw
/// of yaw_rate_radps, which run with tau, and the turns of the pauses. p is the body's position, or the
/// camera's with path_point: camera: in rotation and in pauses this is the point that stays fixed. All
/// derivatives are analytic. Preconditions: config.Validate() is ok, config.trajectory is not kFile.
[[nodiscard]] std::unique_ptr<ContinuousTrajectory> MakeSimTrajectory(const SimulatorConfig& config,
                                                                      std::uint64_t seed = 0);

}  // namespace alidade
