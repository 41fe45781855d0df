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

/// Least squares over all frames of the window with Ceres: `terms`, the landmarks of `tracks` among their
/// unknowns, and the calibration. All are updated in place; with pose-only landmarks those of the tracks are
/// left for SolveLandmark. One thread and no time limit: equal input, equal bits. Errors (kDiverged): the
/// solver failed, or a state is not finite; the window is then as before.
Result<WindowSolveReport> SolveWindow(const SmootherConfig& config, const WindowTerms& terms,
                                      const std::vector<WindowTrack*>& tracks, Window* window,
                                      WindowCalibration* calibration);

}  // namespace alidade
