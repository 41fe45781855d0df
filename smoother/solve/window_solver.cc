#include "smoother/solve/window_solver.h"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "core/blas.h"
#include "smoother/solve/window_problem.h"

namespace alidade {
namespace {

// Ceres adds 1e-8 of the squared norms of the scaled columns (about one), at most of this, to the normal
// equations of a dogleg step. Without the bound the weak directions of a window, its drift and scale, do not
// reach the minimum in any number of steps (docs/smoother.md, Weak directions).
constexpr double kLargestDiagonal = 1e-4;
// First radius of the trust region: length of a step in scaled columns, times the root of the bound. A longer
// first step is cut, one that proves too long is rejected a few times.
constexpr double kTrustRadius = 1e3;
// Rejected steps allowed for each accepted one: they cost an evaluation without Jacobians at most.
constexpr int kRejectedSteps = 3;

// Least mismatch between the cost and its model that a step is credited with: directions in which the model
// promises too much and too little cancel in the ratio of the two.
constexpr double kLeastMismatch = 0.05;

/// Ends the solve after a number of accepted steps, or once a step has left so little to gain that the next
/// one is not worth its evaluation.
class AcceptedSteps final : public ceres::IterationCallback {
 public:
  AcceptedSteps(int most, double remaining_sigma)
      : most_(most), remaining_cost_(0.5 * remaining_sigma * remaining_sigma) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0 || !summary.step_is_successful) {
      return ceres::SOLVER_CONTINUE;
    }
    ++accepted_;
    const bool near = Remaining(summary.cost_change, summary.relative_decrease) < remaining_cost_;
    return near || accepted_ >= most_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
  [[nodiscard]] int accepted() const { return accepted_; }

 private:
  /// By how much the cost still lies above its minimum, after a step that lowered it by `decrease`, `ratio`
  /// times what the model promised. On a parabola whose curvature is a times the model's, a step leaves (1 -
  /// a)^2 of what there was, and ratio = 2 - a.
  static double Remaining(double decrease, double ratio) {
    const double curvature = 2 - ratio;
    const double mismatch = std::max(std::abs(1 - curvature), kLeastMismatch);
    return curvature > 0 ? decrease * mismatch * mismatch / (ratio * curvature)
                         : std::numeric_limits<double>::infinity();
  }

  int most_;
  double remaining_cost_;
  int accepted_ = 0;
};

ceres::Solver::Options SolverOptions(const SmootherConfig& config, ParameterBlocks* blocks) {
  ceres::Solver::Options solver;
  solver.max_num_iterations = (1 + kRejectedSteps) * config.max_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  // Dogleg takes the undamped Gauss-Newton step; Levenberg-Marquardt would damp the weakly observed drift
  // directions first.
  solver.trust_region_strategy_type = ceres::DOGLEG;
  solver.max_lm_diagonal = kLargestDiagonal;
  solver.initial_trust_region_radius = kTrustRadius;
  solver.function_tolerance = 1e-6;
  solver.parameter_tolerance = 1e-9;
  solver.gradient_tolerance = 1e-12;
  if (config.solve_to_rounding) {
    // No tolerance, and a damping of 1e-20 of the squared norms of the scaled columns. In the end the cost is
    // only rounded differently by a step; such steps are no failure.
    solver.min_lm_diagonal = solver.max_lm_diagonal = 1e-12;
    solver.function_tolerance = solver.parameter_tolerance = solver.gradient_tolerance = 0;
    solver.max_num_consecutive_invalid_steps = solver.max_num_iterations;
  }
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.dense_linear_algebra_library_type = ceres::LAPACK;
  // First group: every second bias. No factor couples them with one another, which makes Ceres form the
  // normal equations block by block and leaves the dense factorisation fewer columns. Not the first one: the
  // prior couples it with every frame.
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (int i = 0; i < blocks->frames(); ++i) {
    solver.linear_solver_ordering->AddElementToGroup(blocks->Nav(i), 1);
    solver.linear_solver_ordering->AddElementToGroup(blocks->Bias(i), i % 2 == 1 ? 0 : 1);
    if (blocks->has_clocks()) {
      solver.linear_solver_ordering->AddElementToGroup(blocks->Clock(i), 1);
    }
  }
  solver.linear_solver_ordering->AddElementToGroup(blocks->Calibration(), 1);
  return solver;
}

}  // namespace

Result<WindowSolveReport> SolveWindow(const SmootherConfig& config, const WindowTerms& terms, Window* window,
                                      WindowCalibration* calibration, double remaining_sigma) {
  const std::vector<WindowTrack*> no_tracks;
  WindowProblem problem(config.error, window->frames(), no_tracks, *calibration);
  ParameterBlocks& blocks = problem.blocks();
  for (const std::unique_ptr<WindowTerm>& term : terms) {
    term->AddTo(&problem);
  }
  UseOneThreadPerBlasCall();
  ceres::Solver::Summary summary;
  ceres::Solver::Options options = SolverOptions(config, &blocks);
  AcceptedSteps steps(config.max_iterations, config.solve_to_rounding ? 0 : remaining_sigma);
  options.callbacks.push_back(&steps);
  ceres::Solve(options, &problem.ceres(), &summary);
  if (summary.termination_type == ceres::FAILURE || !blocks.IsFinite()) {
    return Status::Diverged("smoother: solver failed at " + FormatSeconds(window->newest().stamp_ns) +
                            " s: " + summary.message);
  }
  CameraCalibration solved = calibration->mean;
  if (!calibration->At(blocks.Calibration(), &solved)) {
    return Status::Diverged("smoother: calibration at " + FormatSeconds(window->newest().stamp_ns) +
                            " s is no camera");
  }
  calibration->mean = solved;
  blocks.WriteBack();
  return WindowSolveReport{steps.accepted(), summary.initial_cost, summary.final_cost};
}

}  // namespace alidade
