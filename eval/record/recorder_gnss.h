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
[[nodiscard]] std::string AntennaHeader();
/// The row of a record, if it has one. Precondition: `global` is by GNSS.
void AppendAntenna(const RunRecord& record, const GlobalFrame& global, std::string* text);

/// gnss.csv of the epochs in memory.
[[nodiscard]] std::string SatelliteTable(const RunResult& result);

}  // namespace alidade
