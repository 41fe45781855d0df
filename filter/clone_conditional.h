#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "filter/filter_state.h"

namespace alidade {

/// The marginalised clone seen from clones that are near in time and some that are not: x_m = G x_s + w,
/// w ~ N(0, C).
struct CloneConditional {
  static constexpr int kMaxNeighbours = 8;
  int leaving_serial = 0;
  int leaving_slot = 0;
  size_t neighbours = 0;  ///< how many there are
  std::array<int, kMaxNeighbours> neighbour_slots{};
  Eigen::Matrix<double, 6, 6 * kMaxNeighbours> gain;  ///< G; six columns a neighbour
  Matrix6d covariance = Matrix6d::Zero();             ///< C
};

/// How clone `index` follows from others, which reach from its neighbours to the other end of the window: w
/// is taken as independent of the state, and rows of past updates couple clones that are far apart.
/// `memories`: how many are carried over it; w is common to them, and C is scaled so that they may take it
/// for their own (docs/track_memory.md). The state has at least three clones.
void ConditionClone(const FilterState& state, size_t index, size_t memories, CloneConditional* conditional);

}  // namespace alidade
