#pragma once

#include <ceres/problem.h>

#include <memory>
#include <vector>

#include "smoother/solve/parameter_blocks.h"
#include "smoother/solve/reduced_rows.h"

namespace alidade {

/// The least squares of a window in Ceres, which WindowTerms add themselves to.
class WindowProblem {
 public:
  /// As for ParameterBlocks.
  WindowProblem(ErrorConvention error, const WindowFrames& frames, const std::vector<WindowTrack*>& tracks,
                const WindowCalibration& calibration)
      : blocks_(error, frames, tracks, calibration),
        reduced_(&blocks_),
        problem_(blocks_.MakeProblem(&reduced_)) {}
  WindowProblem(const WindowProblem&) = delete;  // Ceres refers to the blocks
  WindowProblem& operator=(const WindowProblem&) = delete;
  WindowProblem(WindowProblem&&) = delete;
  WindowProblem& operator=(WindowProblem&&) = delete;
  ~WindowProblem() = default;

  [[nodiscard]] ParameterBlocks& blocks() { return blocks_; }
  [[nodiscard]] ceres::Problem& ceres() { return *problem_; }
  /// Adds a cost with eliminated landmarks, which must outlive the problem. `parts`: the columns of its
  /// normal equations, see ReducedRows.
  void AddReduced(ReducedCost* cost, const std::vector<TermPart>& parts) {
    reduced_.Add(cost, parts, problem_.get());
  }

 private:
  ParameterBlocks blocks_;
  ReducedRows reduced_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace alidade
