#pragma once

#include "smoother/solve/window_term.h"

namespace alidade {

/// A term whose landmarks are eliminated. In Ceres all such terms of a problem are one set of rows
/// (ReducedRows).
class ReducedTerm : public WindowTerm {
 public:
  void AddTo(WindowProblem* problem) final;

 private:
  /// Its normal equations are over the columns of the term.
  [[nodiscard]] virtual ReducedCost* cost() const = 0;
};

}  // namespace alidade
