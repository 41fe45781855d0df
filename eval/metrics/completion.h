#pragma once

#include <optional>
#include <vector>

#include "core/time.h"
#include "eval/trajectory/trajectory.h"

namespace alidade {

/// Rows of a trajectory that are further apart leave a time without an estimate [s].
inline constexpr double kLongestRowStepS = 0.5;

/// Stamps of the rows of a trajectory.
[[nodiscard]] std::vector<TimeNs> RowStamps(const Trajectory& trajectory);

/// Seconds of [begin_ns, end_ns] that rows cover: the steps between rows at most kLongestRowStepS apart.
/// `stamps_ns` ascend; a step back counts nothing.
[[nodiscard]] double CoveredSeconds(const std::vector<TimeNs>& stamps_ns, TimeNs begin_ns, TimeNs end_ns);
/// The same from the first to the last row.
[[nodiscard]] double CoveredSeconds(const std::vector<TimeNs>& stamps_ns);

/// Share of a run's time with an estimate, 0 to 1: CoveredSeconds of the span from the sequence's first to
/// its last camera frame, over that span. Nothing when the span is empty.
[[nodiscard]] std::optional<double> Completion(const std::vector<TimeNs>& stamps_ns, TimeNs first_frame_ns,
                                               TimeNs last_frame_ns);

}  // namespace alidade
