#pragma once

#include <string>

#include "eval/comparison/comparison.h"

namespace alidade {

/// The page's data: JSON without '<', so its content cannot end the enclosing script element.
[[nodiscard]] std::string ReportData(const Comparison& comparison);

/// report.json: the same for programs, without the series (docs/report.md lists the members).
[[nodiscard]] std::string ReportJson(const Comparison& comparison);

}  // namespace alidade
