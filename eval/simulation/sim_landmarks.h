#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/status.h"
#include "eval/simulation/continuous_trajectory.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// Positions of the body about `spacing_m` apart, in W [m].
[[nodiscard]] std::vector<Eigen::Vector3d> SamplePath(const ContinuousTrajectory& trajectory,
                                                      double spacing_m);

/// Landmarks around the path, in W [m]; none is nearer to the path (sampled every tenth of
/// landmark_min_distance_m) than that distance: one that is gets thrown again.
///
/// shell   Thrown from a random point of the path in a direction uniform in azimuth and at most 20 degrees up
///         or down (like the walls of a hall), to a distance uniform in [min, max]. So its distance to the
///         nearest point of the path lies within [min, max] (to the sampling).
/// room    Thrown evenly over floor, ceiling and walls of an upright box, the path's bounding box extended by
///         room_margin_m on either side; it stands out from its wall by a length uniform in
///         [0, room_depth_m].
/// volume  landmark_density_per_m3 of them, evenly, in the space whose distance to the nearest point of the
///         path lies within [landmark_min_distance_m, landmark_max_distance_m].
///
/// Errors (kConfig): the path leaves no room for landmarks.
Result<std::vector<Eigen::Vector3d>> MakeLandmarks(const SimulatorConfig& config,
                                                   const ContinuousTrajectory& trajectory,
                                                   std::uint64_t seed);

}  // namespace alidade
