#pragma once

#include <string>
#include <vector>

#include "gnss/positioning/single_point_solution.h"

namespace alidade {

// Solutions as RTKLIB's .pos text.

/// The lines before the solutions; those of `remarks` come first, each behind "% ".
[[nodiscard]] std::string PositionFileHeader(const std::vector<std::string>& remarks);
/// The line of one: GPST calendar time, latitude and longitude [deg], height [m], Q = 5 (single), number of
/// satellites, deviations [m], age and ratio 0, then velocity north, east, up with deviations [m/s] (0 where
/// there is none).
void AppendPosition(const SinglePointSolution& solution, std::string* text);

}  // namespace alidade
