#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/estimator_config.h"
#include "core/status.h"
#include "smoother/factors/gnss_factors.h"
#include "smoother/factors/slam_prior.h"

namespace alidade {

/// What the solver needs besides the window.
struct WindowSolveOptions {
  SmootherConfig smoother;
  VisionConfig vision;
  Pose T_BC;
  Eigen::Vector3d gravity_W = Eigen::Vector3d::Zero();
};

struct WindowSolveReport {
  int iterations = 0;
  double initial_cost = 0;
  double final_cost = 0;
};

/// Least squares over all frames of the window with Ceres: prior, IMU factors and the given tracks, which
/// must have landmarks. States are updated in place; with explicit inverse depths the landmarks as well, with
/// pose-only landmarks they are left for SolveLandmark. One thread and no time limit: equal input, equal
/// bits. Errors (kDiverged): an IMU factor cannot be whitened, the solver failed, or a state is not finite;
/// the window is then as before. `gnss`: of an aligned window. `slam`: a prior with landmarks, which then
/// stands for `prior`. `calibration`: of a camera that is calibrated online, updated in place.
Result<WindowSolveReport> SolveWindow(const WindowSolveOptions& options, const LinearPrior& prior,
                                      const std::vector<WindowTrack*>& tracks, Window* window,
                                      const GnssFactorContext* gnss = nullptr,
                                      const SlamPrior* slam = nullptr,
                                      WindowCalibration* calibration = nullptr);

}  // namespace alidade
