#pragma once

#include <cstddef>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// Rows of a series that a plot keeps: every k-th row (the regular ones, which alone may enter means), and
/// additional rows with extremes that the regular ones would miss.
struct SeriesRows {
  std::vector<size_t> kept;   ///< ascending
  std::vector<bool> regular;  ///< parallel to `kept`
};

/// At most `most` regular rows of those that are regular in `series`. Between two of them the row that lies
/// furthest off the straight line between them, in any error, NEES, NIS or time, by a hundredth of that
/// column's range or more; and the lowest and highest row of every such column, so that a plot of the kept
/// rows has each curve's extremes. Not more than 2 `most` + 20 rows in all.
[[nodiscard]] SeriesRows PickRows(const CellSeries& series, size_t most);

/// The series of these rows alone.
[[nodiscard]] CellSeries TakeRows(const CellSeries& series, const SeriesRows& rows);

}  // namespace alidade
