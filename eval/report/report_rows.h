#pragma once

#include <nlohmann/json.hpp>

#include "eval/comparison/aggregate.h"
#include "eval/comparison/comparison.h"

namespace alidade {

// Rows of the page's tables (docs/report.md lists the members of report.json).

[[nodiscard]] nlohmann::ordered_json FigureJson(const Figure& figure);
[[nodiscard]] nlohmann::ordered_json AggregateJson(const AggregateRow& row);
/// `ratios`: bound over achieved, orientation and position each, as the page's headings.
[[nodiscard]] nlohmann::ordered_json EfficiencyJson(const Comparison& comparison);
[[nodiscard]] nlohmann::ordered_json FrontendJson(const Comparison& comparison);

}  // namespace alidade
