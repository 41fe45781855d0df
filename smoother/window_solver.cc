#include "smoother/window_solver.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "smoother/imu_factor.h"
#include "smoother/inverse_depth_factor.h"
#include "smoother/pose_only_factor.h"

namespace alidade {
namespace {

/// Everything one solve hands to Ceres by pointer, and the order in which it is eliminated.
struct SolveStore {
  explicit SolveStore(const WindowSolveOptions& options)
      : manifold(options.smoother.error), kernel{options.vision.robust_kernel, options.vision.robust_scale_sigma} {
    switch (kernel.kernel) {
      case RobustKernel::kHuber:
        loss = std::make_unique<ceres::HuberLoss>(kernel.scale_sigma);
        break;
      case RobustKernel::kCauchy:
        loss = std::make_unique<ceres::CauchyLoss>(kernel.scale_sigma);
        break;
      case RobustKernel::kNone:
        break;
    }
  }

  NavStateManifold manifold;
  ObservationKernel kernel;
  std::unique_ptr<ceres::LossFunction> loss;
  std::deque<LiftedCost<ImuFactor>> imu;
  std::deque<LiftedCost<InverseDepthFactor>> inverse_depth;
  std::deque<LiftedCost<BaseBearingFactor>> base_bearing;
  std::optional<LiftedCost<PoseOnlyFactor>> pose_only;
  std::optional<LiftedCost<PriorFactor>> prior;
};

ceres::Problem::Options ProblemOptions() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

void AddPrior(const LinearPrior& prior, Window* window, SolveStore* store, ceres::Problem* problem) {
  store->prior.emplace(PriorFactor(&prior));
  std::vector<double*> blocks;
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    WindowFrame& frame = window->frame(prior.anchors[i].frame->index);
    blocks.push_back(frame.nav.data());
    if (i == 0) {
      blocks.push_back(frame.bias.data());
    }
  }
  problem->AddResidualBlock(&*store->prior, nullptr, blocks);
}

Status AddImu(const WindowSolveOptions& options, Window* window, SolveStore* store, ceres::Problem* problem) {
  for (int i = 0; i + 1 < window->size(); ++i) {
    WindowFrame& first = window->frame(i);
    WindowFrame& second = window->frame(i + 1);
    const ImuFactor factor(&*second.preintegration, options.gravity_W, second.mean_step_s());
    if (!factor.valid()) {
      return Status::Diverged("smoother: IMU covariance up to " + FormatSeconds(second.stamp_ns) +
                              " s is not positive definite");
    }
    store->imu.emplace_back(factor);
    problem->AddResidualBlock(&store->imu.back(), nullptr, first.nav.data(), first.bias.data(), second.nav.data(),
                              second.bias.data());
  }
  return Status::Ok();
}

void AddInverseDepth(const WindowSolveOptions& options, const std::vector<WindowTrack*>& tracks, Window* window,
                     SolveStore* store, ceres::Problem* problem) {
  for (WindowTrack* track : tracks) {
    double* landmark = track->landmark.data();
    double* base = window->frame(track->views.front().frame->index).nav.data();
    store->base_bearing.emplace_back(BaseBearingFactor(track->views.front().observation));
    problem->AddResidualBlock(&store->base_bearing.back(), store->loss.get(), landmark);
    for (size_t k = 1; k < track->views.size(); ++k) {
      const WindowView& view = track->views[k];
      store->inverse_depth.emplace_back(InverseDepthFactor(view.observation, &options.T_BC));
      problem->AddResidualBlock(&store->inverse_depth.back(), store->loss.get(), base,
                                window->frame(view.frame->index).nav.data(), landmark);
    }
  }
}

void AddPoseOnly(const WindowSolveOptions& options, const std::vector<WindowTrack*>& tracks, Window* window,
                 SolveStore* store, ceres::Problem* problem) {
  std::vector<double*> blocks;
  for (int i = 0; i < window->size(); ++i) {
    blocks.push_back(window->frame(i).nav.data());
  }
  store->pose_only.emplace(
      PoseOnlyFactor(window->size(), {tracks.begin(), tracks.end()}, options.T_BC, store->kernel));
  problem->AddResidualBlock(&*store->pose_only, nullptr, blocks);
}

ceres::Solver::Options SolverOptions(const WindowSolveOptions& options, const std::vector<WindowTrack*>& tracks,
                                     Window* window) {
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.smoother.max_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  // Dogleg takes the undamped Gauss-Newton step; Levenberg-Marquardt would damp the weakly observed drift directions first.
  solver.trust_region_strategy_type = ceres::DOGLEG;
  solver.function_tolerance = 1e-6;
  solver.parameter_tolerance = 1e-9;
  solver.gradient_tolerance = 1e-12;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  // First group: blocks no factor couples with one another. Landmarks where they are explicit; else every second bias, which
  // makes Ceres form the normal equations block by block and leaves the dense factorisation fewer columns.
  const bool explicit_landmarks = options.smoother.landmark == SmootherLandmark::kInverseDepth && !tracks.empty();
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  if (explicit_landmarks) {
    for (WindowTrack* track : tracks) {
      solver.linear_solver_ordering->AddElementToGroup(track->landmark.data(), 0);
    }
  }
  for (int i = 0; i < window->size(); ++i) {
    WindowFrame& frame = window->frame(i);
    solver.linear_solver_ordering->AddElementToGroup(frame.nav.data(), 1);
    solver.linear_solver_ordering->AddElementToGroup(frame.bias.data(), !explicit_landmarks && i % 2 == 0 ? 0 : 1);
  }
  return solver;
}

bool AllFinite(const Window& window) {
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    for (const double value : frame->nav) {
      if (!std::isfinite(value)) return false;
    }
    for (const double value : frame->bias) {
      if (!std::isfinite(value)) return false;
    }
  }
  return true;
}

}  // namespace

Result<WindowSolveReport> SolveWindow(const WindowSolveOptions& options, const LinearPrior& prior,
                                      const std::vector<WindowTrack*>& tracks, Window* window) {
  SolveStore store(options);
  ceres::Problem problem(ProblemOptions());
  for (int i = 0; i < window->size(); ++i) {
    problem.AddParameterBlock(window->frame(i).nav.data(), kNavAmbientSize, &store.manifold);
    problem.AddParameterBlock(window->frame(i).bias.data(), 6);
  }
  AddPrior(prior, window, &store, &problem);
  ALIDADE_RETURN_IF_ERROR(AddImu(options, window, &store, &problem));
  if (tracks.empty()) {
    // prior and IMU alone
  } else if (options.smoother.landmark == SmootherLandmark::kInverseDepth) {
    AddInverseDepth(options, tracks, window, &store, &problem);
  } else {
    AddPoseOnly(options, tracks, window, &store, &problem);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(SolverOptions(options, tracks, window), &problem, &summary);
  if (summary.termination_type == ceres::FAILURE || !AllFinite(*window)) {
    return Status::Diverged("smoother: solver failed at " + FormatSeconds(window->newest().stamp_ns) +
                            " s: " + summary.message);
  }
  return WindowSolveReport{static_cast<int>(summary.iterations.size()) - 1, summary.initial_cost, summary.final_cost};
}

}  // namespace alidade
