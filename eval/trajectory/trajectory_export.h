#pragma once

#include <string>

#include "eval/trajectory/trajectory.h"

namespace alidade {

/// TUM text, as evo and the rpg tools read it: "stamp_s x y z qx qy qz qw", the stamp printed from the
/// integer with nine decimals, numbers the shortest that read back equal, w >= 0. No header.
[[nodiscard]] std::string FormatTum(const Trajectory& trajectory);
/// One row of it.
void AppendTum(const TrajectoryPoint& point, std::string* text);

}  // namespace alidade
