#pragma once

#include <string>
#include <vector>

#include "eval/comparison/aggregate.h"

namespace alidade {

/// What stands in the place of a value that is unknown.
inline constexpr const char* kDash = "\u2013";

/// A cell of a table; the renderer decides how it is marked.
struct TextCell {
  std::string text;
  bool best = false;
};

struct TextRow {
  std::vector<TextCell> cells;
  bool reference = false;  ///< a published figure, not a measured one
};

/// First column left-aligned, the others right-aligned. All rows are as long as the header.
struct TextTable {
  std::string title;
  std::vector<std::string> header;
  std::vector<TextRow> rows;
};

/// Rounds to `decimals`; small values keep two significant digits, very large ones use exponents; NaN gives a
/// dash.
[[nodiscard]] std::string FormatValue(double value, int decimals);

/// "mean +- standard error"; the error only when it is known.
[[nodiscard]] std::string FormatStatistic(const Statistic& statistic, int decimals,
                                          const std::string& plus_minus);

}  // namespace alidade
