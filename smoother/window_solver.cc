#include "smoother/window_solver.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "smoother/imu_factor.h"
#include "smoother/inverse_depth_factor.h"
#include "smoother/pose_only_factor.h"
#include "smoother/rest_factor.h"

namespace alidade {
namespace {

constexpr size_t kFrameStride = 16;    // nav (10) and bias (6)
constexpr size_t kLandmarkStride = 4;  // one spare, so that every block stays 16-byte aligned

/// Everything one solve hands to Ceres by pointer. All parameter blocks lie in one array in a fixed order:
/// Ceres sorts the blocks of an elimination group by ADDRESS, so blocks scattered over the heap would make
/// the rounding depend on its history.
struct SolveStore {
  SolveStore(const WindowSolveOptions& options, const std::vector<WindowTrack*>& selected,
             const Window& window)
      : tracks(selected),
        frames(static_cast<size_t>(window.size())),
        parameters(kFrameStride * frames + kLandmarkStride * tracks.size()),
        manifold(options.smoother.error),
        kernel{options.vision.robust_kernel, options.vision.robust_scale_sigma} {
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
    for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
      std::copy(frame->nav.begin(), frame->nav.end(), Nav(frame->index));
      std::copy(frame->bias.begin(), frame->bias.end(), Bias(frame->index));
    }
    for (size_t i = 0; i < tracks.size(); ++i) {
      std::copy_n(tracks[i]->landmark.data(), 3, Landmark(i));
    }
  }

  double* Nav(int frame) { return &parameters[kFrameStride * static_cast<size_t>(frame)]; }
  double* Bias(int frame) { return Nav(frame) + kNavAmbientSize; }
  double* Landmark(size_t track) { return &parameters[kFrameStride * frames + kLandmarkStride * track]; }

  void WriteBack(Window* window) {
    for (int i = 0; i < window->size(); ++i) {
      WindowFrame& frame = window->frame(i);
      std::copy_n(Nav(i), frame.nav.size(), frame.nav.begin());
      std::copy_n(Bias(i), frame.bias.size(), frame.bias.begin());
    }
    for (size_t i = 0; i < tracks.size(); ++i) {
      std::copy_n(Landmark(i), 3, tracks[i]->landmark.data());
    }
  }

  const std::vector<WindowTrack*>& tracks;
  size_t frames;
  std::vector<double> parameters;
  NavStateManifold manifold;
  ObservationKernel kernel;
  std::unique_ptr<ceres::LossFunction> loss;
  std::deque<LiftedCost<ImuFactor>> imu;
  std::deque<LiftedCost<RestFactor>> rest;
  std::deque<LiftedCost<InverseDepthFactor>> inverse_depth;
  std::deque<LiftedCost<BaseBearingFactor>> base_bearing;
  std::deque<LiftedCost<DepthPriorFactor>> depth_prior;
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

void AddPrior(const LinearPrior& prior, SolveStore* store, ceres::Problem* problem) {
  store->prior.emplace(PriorFactor(&prior));
  std::vector<double*> blocks;
  for (size_t i = 0; i < prior.anchors.size(); ++i) {
    blocks.push_back(store->Nav(prior.anchors[i].frame->index));
    if (i == 0) {
      blocks.push_back(store->Bias(prior.anchors[i].frame->index));
    }
  }
  problem->AddResidualBlock(&*store->prior, nullptr, blocks);
}

Status AddImu(const WindowSolveOptions& options, const Window& window, SolveStore* store,
              ceres::Problem* problem) {
  for (int i = 0; i + 1 < window.size(); ++i) {
    const WindowFrame& next = window.frame(i + 1);
    const ImuFactor factor(&*next.preintegration, options.gravity_W, next.mean_step_s());
    if (!factor.valid()) {
      return Status::Diverged("smoother: IMU covariance up to " + FormatSeconds(next.stamp_ns) +
                              " s is not positive definite");
    }
    store->imu.emplace_back(factor);
    problem->AddResidualBlock(&store->imu.back(), nullptr, store->Nav(i), store->Bias(i), store->Nav(i + 1),
                              store->Bias(i + 1));
  }
  return Status::Ok();
}

void AddRest(const Window& window, SolveStore* store, ceres::Problem* problem) {
  for (const std::unique_ptr<WindowFrame>& frame : window.frames()) {
    if (frame->rest) {
      store->rest.emplace_back(RestFactor(*frame->rest));
      problem->AddResidualBlock(&store->rest.back(), nullptr, store->Nav(frame->index),
                                store->Bias(frame->index));
    }
  }
}

void AddInverseDepth(const WindowSolveOptions& options, SolveStore* store, ceres::Problem* problem) {
  for (size_t i = 0; i < store->tracks.size(); ++i) {
    const std::vector<WindowView>& views = store->tracks[i]->views;
    store->base_bearing.emplace_back(BaseBearingFactor(views.front().observation));
    problem->AddResidualBlock(&store->base_bearing.back(), store->loss.get(), store->Landmark(i));
    if (store->tracks[i]->depth_prior.sqrt_information > 0) {
      store->depth_prior.emplace_back(DepthPriorFactor(store->tracks[i]->depth_prior));
      problem->AddResidualBlock(&store->depth_prior.back(), nullptr, store->Landmark(i));
    }
    for (size_t k = 1; k < views.size(); ++k) {
      store->inverse_depth.emplace_back(InverseDepthFactor(views[k].observation, &options.T_BC));
      problem->AddResidualBlock(&store->inverse_depth.back(), store->loss.get(),
                                store->Nav(views.front().frame->index), store->Nav(views[k].frame->index),
                                store->Landmark(i));
    }
  }
}

void AddPoseOnly(const WindowSolveOptions& options, int frames, SolveStore* store, ceres::Problem* problem) {
  std::vector<double*> blocks;
  for (int i = 0; i < frames; ++i) {
    blocks.push_back(store->Nav(i));
  }
  store->pose_only.emplace(
      PoseOnlyFactor(frames, {store->tracks.begin(), store->tracks.end()}, options.T_BC, store->kernel));
  problem->AddResidualBlock(&*store->pose_only, nullptr, blocks);
}

ceres::Solver::Options SolverOptions(const WindowSolveOptions& options, int frames, SolveStore* store) {
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
  const bool explicit_landmarks =
      options.smoother.landmark == SmootherLandmark::kInverseDepth && !store->tracks.empty();
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (size_t i = 0; explicit_landmarks && i < store->tracks.size(); ++i) {
    solver.linear_solver_ordering->AddElementToGroup(store->Landmark(i), 0);
  }
  for (int i = 0; i < frames; ++i) {
    solver.linear_solver_ordering->AddElementToGroup(store->Nav(i), 1);
    solver.linear_solver_ordering->AddElementToGroup(store->Bias(i),
                                                     !explicit_landmarks && i % 2 == 0 ? 0 : 1);
  }
  return solver;
}

}  // namespace

Result<WindowSolveReport> SolveWindow(const WindowSolveOptions& options, const LinearPrior& prior,
                                      const std::vector<WindowTrack*>& tracks, Window* window) {
  const int frames = window->size();
  SolveStore store(options, tracks, *window);
  ceres::Problem problem(ProblemOptions());
  for (int i = 0; i < frames; ++i) {
    problem.AddParameterBlock(store.Nav(i), kNavAmbientSize, &store.manifold);
    problem.AddParameterBlock(store.Bias(i), 6);
  }
  AddPrior(prior, &store, &problem);
  ALIDADE_RETURN_IF_ERROR(AddImu(options, *window, &store, &problem));
  AddRest(*window, &store, &problem);
  if (options.smoother.landmark == SmootherLandmark::kInverseDepth) {
    AddInverseDepth(options, &store, &problem);
  } else if (!tracks.empty()) {
    AddPoseOnly(options, frames, &store, &problem);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(SolverOptions(options, frames, &store), &problem, &summary);
  const bool finite = std::all_of(store.parameters.begin(), store.parameters.end(),
                                  [](double value) { return std::isfinite(value); });
  if (summary.termination_type == ceres::FAILURE || !finite) {
    return Status::Diverged("smoother: solver failed at " + FormatSeconds(window->newest().stamp_ns) +
                            " s: " + summary.message);
  }
  store.WriteBack(window);
  return WindowSolveReport{static_cast<int>(summary.iterations.size()) - 1, summary.initial_cost,
                           summary.final_cost};
}

}  // namespace alidade
