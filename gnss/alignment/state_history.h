#pragma once

#include <deque>
#include <optional>

#include "gnss/alignment/alignment_fit.h"

namespace alidade {

/// The last seconds of a visual-inertial estimate, to be read at the times of other measurements.
class StateHistory {
 public:
  /// Rising stamps; another state is passed over. Its acceleration is that since the state before.
  void Add(AlignmentState state);
  /// True when no later state is needed for this time.
  [[nodiscard]] bool Reaches(TimeNs stamp_ns) const {
    return !states_.empty() && stamp_ns <= states_.back().stamp_ns;
  }
  /// The estimate at a time that two states embrace, not more than two seconds apart: position by the cubic
  /// that fits both velocities, the rest linearly. Nothing elsewhere.
  [[nodiscard]] std::optional<AlignmentState> At(TimeNs stamp_ns) const;
  [[nodiscard]] bool empty() const { return states_.empty(); }
  /// Precondition: not empty.
  [[nodiscard]] const AlignmentState& newest() const { return states_.back(); }

 private:
  std::deque<AlignmentState> states_;
};

}  // namespace alidade
