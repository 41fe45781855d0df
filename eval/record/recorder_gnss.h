#pragma once

#include <string>

#include "eval/record/run_result.h"

namespace alidade {

/// Whether raw GNSS brought the states of the run into the ENU frame.
[[nodiscard]] bool HasGnss(const RunResult& result);

/// Names of the clock terms behind the other columns of states.csv, each with a leading comma.
[[nodiscard]] std::string ClockColumns();
/// The terms of one row, likewise; empty fields before the alignment.
[[nodiscard]] std::string ClockFields(const RunRecord& record);

/// trajectory.pos: the antenna in RTKLIB's format, from the alignment on. Q is 5; ns the satellites used
/// since the row before; velocities are those of the body, and their deviations not given.
[[nodiscard]] std::string AntennaPositions(const RunResult& result, double time_offset_s);

/// gnss.csv: every satellite of every used epoch with direction, residuals and whether it was used.
[[nodiscard]] std::string SatelliteTable(const RunResult& result);

}  // namespace alidade
