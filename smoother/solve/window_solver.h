#pragma once

#include <vector>

#include "core/smoother_config.h"
#include "core/status.h"
#include "smoother/solve/window_term.h"

namespace alidade {

struct WindowSolveReport {
  int iterations = 0;  ///< accepted steps
  double initial_cost = 0;
  double final_cost = 0;
};

/// The cost is half a squared Mahalanobis distance of all states of the window together. A solve ends once
/// that of the minimum is expected to be below this; no single state is then further away in its own
/// deviations.
inline constexpr double kRemainingSigma = 0.1;

/// Least squares of `terms` over all frames of the window and the calibration with Ceres; both are updated in
/// place. The landmarks of tracks are eliminated (PoseOnlyTerm::SolvedLandmarks). `remaining_sigma`: see
/// kRemainingSigma; 0 goes on until the cost stands still. One thread and no time limit: equal input, equal
/// bits. Errors (kDiverged): the solver failed, or a state is not finite; the window is then as before.
Result<WindowSolveReport> SolveWindow(const SmootherConfig& config, const WindowTerms& terms, Window* window,
                                      WindowCalibration* calibration,
                                      double remaining_sigma = kRemainingSigma);

}  // namespace alidade
