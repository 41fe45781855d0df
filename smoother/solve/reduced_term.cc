#include "smoother/solve/reduced_term.h"

#include "smoother/solve/window_problem.h"

namespace alidade {

void ReducedTerm::AddTo(WindowProblem* problem) {
  problem->AddReduced(cost(), parts());
}

}  // namespace alidade
