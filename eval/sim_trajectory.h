#pragma once

#include <memory>

#include "eval/continuous_trajectory.h"
#include "eval/simulator.h"

namespace alidade {

/// The analytic trajectory that a simulator configuration describes.
///
/// Position over the phase u (one lap is 2 pi; L, W, h = length, width, height):
///   figure8   p = (L/2 sin u, W/2 sin 2u, h sin 3u)       Gerono's lemniscate, starts at the origin
///   ellipse   p = (L/2 cos u, W/2 sin u,  h sin 3u)
/// The phase runs evenly with the warped time tau(t), scaled so that the whole sequence travels path_m. tau =
/// t without rest; with rest, d tau / dt is 0 during rest_s and rises to 1 within rest_ramp_s by the
/// polynomial of degree 9 whose first four derivatives vanish at both ends, so acceleration stays three times
/// continuously differentiable. The body (x forward, y left, z up) points along the tangent, with a wobble in
/// roll, pitch and yaw that runs with tau. All derivatives are analytic. Precondition: config.Validate() is
/// ok.
[[nodiscard]] std::unique_ptr<ContinuousTrajectory> MakeSimTrajectory(const SimulatorConfig& config);

}  // namespace alidade
