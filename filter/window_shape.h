#pragma once

#include <Eigen/Core>

#include "filter/filter_state.h"

namespace alidade {

/// How far a correction deforms the window, the positions of its cameras as the newest one sees them, as a
/// share of its extent; 0 for a window without extent. correction: of the state's error.
[[nodiscard]] double RelativeDeformation(const FilterState& state,
                                         const Eigen::Ref<const Eigen::VectorXd>& correction);

/// Relative standard deviations of the oldest camera's position as the newest one sees it.
struct BaselineDeviation {
  double across = 0;  ///< the line between them
  double along = 0;   ///< the scale, in which the rows are linear
};

/// Zero for less than two clones, infinite where the two are at one place.
[[nodiscard]] BaselineDeviation MeasureBaseline(const FilterState& state);

}  // namespace alidade
