#pragma once

#include <cstdint>
#include <memory>

#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// The analytic trajectory that a simulator configuration describes.
///
/// Position over the phase u (L, W, h = length, width, height):
///   figure8   p = (L/2 sin u, W/2 sin 2u, h sin 3u)       Gerono's lemniscate, starts at the origin
///   ellipse   p = (L/2 cos u, W/2 sin u,  h sin 3u)
///   wander    p = (L/2 s_x(u), W/2 s_y(u), h s_z(u)),  s(u) = sum_{i=1..4} a_i sin(f_i u + c_i),  sum a_i =
///   1
/// with frequencies f_i near 0.5, 0.87, 1.41, 2.24 and offsets c_i drawn from the seed: a path that stays
/// in its box and never repeats, for runs of any length. The other two do not depend on the seed.
///
/// The phase runs evenly with the warped time tau(t), scaled so that the whole sequence travels path_m. tau =
/// t without rest; with rest, d tau / dt is 0 during rest_s and rises to 1 within rest_ramp_s by the
/// polynomial of degree 9 whose first four derivatives vanish at both ends, so acceleration stays three times
/// continuously differentiable. The body (x forward, y left, z up) points along the tangent of figure8 and
/// ellipse; in wander, which may stand still for a moment, yaw (within 1.5 pi) and pitch (within 0.3 rad) are
/// sums like s of their own. A wobble in roll, pitch and yaw that runs with tau is added. All derivatives are
/// analytic. Preconditions: config.Validate() is ok, config.trajectory is not kFile.
[[nodiscard]] std::unique_ptr<ContinuousTrajectory> MakeSimTrajectory(const SimulatorConfig& config,
                                                                      std::uint64_t seed = 0);

}  // namespace alidade
