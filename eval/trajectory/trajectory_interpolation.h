#pragma once

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Index of the first point at or after `stamp_ns`; size() when there is none.
[[nodiscard]] std::size_t FirstAtOrAfter(const std::vector<TrajectoryPoint>& points, TimeNs stamp_ns);

/// Between two points: geodesic in rotation, linear in the rest; the covariance is that of `before`.
/// Precondition: before.stamp_ns < after.stamp_ns.
[[nodiscard]] TrajectoryPoint Interpolate(const TrajectoryPoint& before, const TrajectoryPoint& after,
                                          TimeNs stamp_ns);

/// Truth at `stamp_ns`, interpolated between its neighbouring rows. kInput: the stamp lies outside the truth
/// or in a gap longer than 0.1 s.
Result<TrajectoryPoint> InterpolateTruth(const Trajectory& truth, TimeNs stamp_ns);

}  // namespace alidade
