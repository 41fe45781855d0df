#pragma once

#include <vector>

#include "smoother/batch/sequence_problem.h"

namespace alidade {

/// The terms of a sequence in time order, and the frames in which its landmarks enter and leave.
struct SequenceOrder {
  explicit SequenceOrder(const SequenceProblem& problem);

  std::vector<std::vector<const WindowTerm*>> at;       ///< by the one frame that they concern
  std::vector<std::vector<const WindowTerm*>> between;  ///< by the later of the two that they concern
  std::vector<std::vector<int>> begins;                 ///< landmarks by their first frame
  std::vector<int> last_frame;                          ///< of each landmark, -1: none
};

}  // namespace alidade
