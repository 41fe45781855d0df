#include "smoother/solve/window_solver.h"

#include <ceres/solver.h>

#include <memory>
#include <string>

#include "smoother/solve/solve_store.h"

namespace alidade {
namespace {

ceres::Solver::Options SolverOptions(const WindowSolveOptions& options, int frames, size_t tracks,
                                     SolveStore* store) {
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.smoother.max_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  // Dogleg takes the undamped Gauss-Newton step; Levenberg-Marquardt would damp the weakly observed drift
  // directions first.
  solver.trust_region_strategy_type = ceres::DOGLEG;
  solver.function_tolerance = 1e-6;
  solver.parameter_tolerance = 1e-9;
  solver.gradient_tolerance = 1e-12;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  // First group: blocks no factor couples with one another. Landmarks where they are explicit; else every
  // second bias, which makes Ceres form the normal equations block by block and leaves the dense
  // factorisation fewer columns.
  const bool explicit_landmarks = options.smoother.landmark == SmootherLandmark::kInverseDepth && tracks > 0;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (size_t i = 0; explicit_landmarks && i < tracks; ++i) {
    solver.linear_solver_ordering->AddElementToGroup(store->Landmark(i), 0);
  }
  for (int i = 0; i < frames; ++i) {
    solver.linear_solver_ordering->AddElementToGroup(store->Nav(i), 1);
    solver.linear_solver_ordering->AddElementToGroup(store->Bias(i),
                                                     !explicit_landmarks && i % 2 == 0 ? 0 : 1);
    if (store->has_clocks()) {
      solver.linear_solver_ordering->AddElementToGroup(store->Clock(i), 1);
    }
  }
  if (store->has_calibration()) {
    solver.linear_solver_ordering->AddElementToGroup(store->Calibration(), 1);
  }
  return solver;
}

}  // namespace

Result<WindowSolveReport> SolveWindow(const WindowSolveOptions& options, const LinearPrior& prior,
                                      const std::vector<WindowTrack*>& tracks, Window* window,
                                      const GnssFactorContext* gnss, const SlamPrior* slam,
                                      WindowCalibration* calibration) {
  const int frames = window->size();
  const ObservationKernel kernel{options.vision.robust_kernel, options.vision.robust_scale_sigma};
  SolveStore store(options.smoother.error, kernel, window->frames(), tracks, calibration);
  const std::unique_ptr<ceres::Problem> problem = store.MakeProblem();
  if (slam != nullptr) {
    store.AddSlamPrior(*slam, problem.get());
  } else {
    store.AddPrior(prior, problem.get());
  }
  ALIDADE_RETURN_IF_ERROR(store.AddImu(options.gravity_W, problem.get()));
  store.AddRest(problem.get());
  if (gnss != nullptr) {
    store.AddGnss(*gnss, problem.get());
  }
  if (options.smoother.landmark == SmootherLandmark::kInverseDepth) {
    store.AddInverseDepth(options.T_BC, problem.get());
  } else if (!tracks.empty()) {
    store.AddPoseOnly(*window, options.T_BC, problem.get());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(SolverOptions(options, frames, tracks.size(), &store), problem.get(), &summary);
  if (summary.termination_type == ceres::FAILURE || !store.IsFinite()) {
    return Status::Diverged("smoother: solver failed at " + FormatSeconds(window->newest().stamp_ns) +
                            " s: " + summary.message);
  }
  if (calibration != nullptr && !calibration->At(store.Calibration(), &calibration->mean)) {
    return Status::Diverged("smoother: calibration at " + FormatSeconds(window->newest().stamp_ns) +
                            " s is no camera");
  }
  store.WriteBack();
  return WindowSolveReport{static_cast<int>(summary.iterations.size()) - 1, summary.initial_cost,
                           summary.final_cost};
}

}  // namespace alidade
