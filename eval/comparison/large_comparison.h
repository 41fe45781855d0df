#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "eval/comparison/comparison.h"

namespace alidade {

/// Bounds what a comparison of many cells holds in memory and shows a run. All cells enter every table. With
/// more than kMostShown, curves have kPoints evenly spaced rows, and only the first cells of each estimator
/// and sequence are shown a run, besides those that failed; of the others the NEES at these rows is kept, for
/// its mean.
class ShownCells {
 public:
  static constexpr size_t kMostShown = 2000;
  static constexpr size_t kPoints = 60;

  ShownCells() = default;  ///< all, whole
  /// group: of each cell a number for its estimator and sequence, below `groups`.
  ShownCells(const std::vector<size_t>& group, size_t groups);

  /// Drops of the index-th cell what is not kept, and sets `shown`.
  void Thin(size_t index, CellResult* cell) const;
  /// For people: what is not shown; empty when all is.
  [[nodiscard]] std::string note() const;

 private:
  std::vector<bool> shown_;  ///< a cell; empty: all, whole
};

}  // namespace alidade
