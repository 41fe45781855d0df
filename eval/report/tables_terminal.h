#pragma once

#include <string>

#include "eval/comparison/comparison.h"

namespace alidade {

/// The tables of a comparison for a terminal.
[[nodiscard]] std::string FormatTable(const Comparison& comparison);

}  // namespace alidade
