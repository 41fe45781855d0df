#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Indices of a truth row and an estimate row that are a pair.
using RowPair = std::pair<std::size_t, std::size_t>;

/// The double nearest to the stamp in seconds, as a decimal text is read. At Unix time doubles have steps of
/// 0.24 us.
[[nodiscard]] double ToDoubleSeconds(TimeNs stamp_ns);

/// The pairs of evo (evo 1.36, `associate_trajectories`): each row of the shorter trajectory, of the estimate
/// when both are equally long, takes the row of the other that is nearest in time, if it is at most
/// `max_dt_s` away; of two equally near ones the earlier. A row of the longer trajectory may be in several
/// pairs. Stamps are compared as doubles of seconds. In the order of the shorter trajectory.
[[nodiscard]] std::vector<RowPair> MatchAsEvo(const Trajectory& truth, const Trajectory& estimate,
                                              double max_dt_s);

/// The pairs of rpg_trajectory_evaluation (and of the TUM RGB-D benchmark): of all pairs of rows less than
/// `max_dt_s` apart, the nearest first, each that has neither row taken. One to one; neighbouring pairs may
/// cross in time. Stamps are compared as doubles of seconds. In the order of the estimate.
[[nodiscard]] std::vector<RowPair> MatchAsRpg(const Trajectory& truth, const Trajectory& estimate,
                                              double max_dt_s);

}  // namespace alidade
