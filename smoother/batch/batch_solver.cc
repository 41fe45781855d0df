#include "smoother/batch/batch_solver.h"

#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <cmath>
#include <memory>

#include "core/blas.h"
#include "core/format.h"
#include "core/imu_propagation.h"
#include "smoother/solve/prior_terms.h"
#include "smoother/solve/sensor_terms.h"
#include "smoother/solve/vision_terms.h"
#include "smoother/solve/window_problem.h"

namespace alidade {
namespace {

constexpr int kGateRounds = 4;
constexpr int kMaxSolves = 8;

class StopCallback final : public ceres::IterationCallback {
 public:
  explicit StopCallback(const std::atomic<bool>* stop) : stop_(stop) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return stop_ != nullptr && stop_->load() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::atomic<bool>* stop_;
};

ceres::Solver::Options SolverOptions(const BatchConfig& config, ParameterBlocks* blocks) {
  ceres::Solver::Options solver;
  solver.max_num_iterations = config.max_iterations;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  solver.linear_solver_type = ceres::SPARSE_SCHUR;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  // The drift of a long sequence is determined ten orders of magnitude less than the steps between frames:
  // any usual damping would hold it where it started. So the first step is all but undamped.
  solver.initial_trust_region_radius = 1e16;
  solver.max_trust_region_radius = 1e18;
  solver.min_lm_diagonal = 1e-12;
  solver.function_tolerance = 1e-10;
  solver.parameter_tolerance = 1e-14;
  solver.gradient_tolerance = 1e-14;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (int i = 0; i < blocks->landmarks(); ++i) {
    solver.linear_solver_ordering->AddElementToGroup(blocks->Landmark(i), 0);
  }
  for (int i = 0; i < blocks->frames(); ++i) {
    solver.linear_solver_ordering->AddElementToGroup(blocks->Nav(i), 1);
    solver.linear_solver_ordering->AddElementToGroup(blocks->Bias(i), 1);
    if (blocks->has_clocks()) {
      solver.linear_solver_ordering->AddElementToGroup(blocks->Clock(i), 1);
    }
  }
  return solver;
}

/// Steps 1 to 3 of SolveBatch.
class BatchSolve {
 public:
  BatchSolve(const EstimatorConfig& config, const std::atomic<bool>* stop, BatchSequence* sequence)
      : config_(config),
        gravity_W_(GravityInWorld(config.imu.gravity_mps2)),
        kernel_{config.batch.robust_kernel, config.vision.robust_scale_sigma},
        stop_(stop),
        sequence_(*sequence) {}

  Result<BatchReport> Execute() {
    report_.selection = sequence_.Select(false);
    ALIDADE_RETURN_IF_ERROR(Solve(GuardKernel(config_.vision)));
    bool gating = true;
    while (!Stopped() && report_.solves < kMaxSolves) {
      if (gating) {
        report_.selection = sequence_.Select(true);
        gating = report_.selection.changed && report_.solves < kGateRounds;
      }
      ALIDADE_RETURN_IF_ERROR(Solve(kernel_));
      if (gating || Stopped()) {
        continue;
      }
      ALIDADE_RETURN_IF_ERROR(Factorize(false));
      if (report_.covariance.newton_decrement <= Square(config_.batch.tolerance_sigma)) {
        ALIDADE_RETURN_IF_ERROR(Factorize(true));
        return std::move(report_);
      }
    }
    report_.stopped = Stopped();
    return report_.stopped
               ? Result<BatchReport>(std::move(report_))
               : Status::Diverged(
                     Format("batch: %.3g sigma from the minimum after %d iterations; expected at most %g",
                            std::sqrt(report_.covariance.newton_decrement), report_.iterations,
                            config_.batch.tolerance_sigma));
  }

 private:
  static double Square(double x) { return x * x; }
  [[nodiscard]] bool Stopped() const { return stop_ != nullptr && stop_->load(); }

  Status AddTerms(const ObservationKernel& kernel, const std::vector<WindowTrack*>& tracks,
                  WindowTerms* terms) const {
    const WindowFrames& frames = sequence_.frames();
    terms->push_back(MakePriorTerm(sequence_.prior(), sequence_.calibration()));
    ALIDADE_RETURN_IF_ERROR(AddSensorTerms({gravity_W_, sequence_.gnss().context()}, frames,
                                           static_cast<int>(frames.size()), terms));
    AddTrackTerms(frames, tracks, sequence_.calibration(), kernel, terms);
    return Status::Ok();
  }

  Status Solve(const ObservationKernel& kernel) {
    sequence_.Preintegrate();
    const std::vector<WindowTrack*> tracks = sequence_.SelectedTracks();
    WindowTerms terms;
    ALIDADE_RETURN_IF_ERROR(AddTerms(kernel, tracks, &terms));
    WindowProblem problem(config_.smoother.error, sequence_.frames(), tracks, sequence_.calibration());
    ParameterBlocks& blocks = problem.blocks();
    for (const std::unique_ptr<WindowTerm>& term : terms) {
      term->AddTo(&problem);
    }
    ceres::Solver::Options options = SolverOptions(config_.batch, &blocks);
    UseOneThreadPerBlasCall();  // CHOLMOD's supernodes
    StopCallback callback(stop_);
    options.callbacks.push_back(&callback);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem.ceres(), &summary);
    if (summary.termination_type == ceres::FAILURE || !blocks.IsFinite()) {
      return Status::Diverged("batch: solver failed: " + summary.message);
    }
    blocks.WriteBack();
    ++report_.solves;
    report_.iterations += static_cast<int>(summary.iterations.size()) - 1;
    report_.final_cost = summary.final_cost;
    return Status::Ok();
  }

  Status Factorize(bool with_covariance) {
    sequence_.Preintegrate();
    const std::vector<WindowTrack*> tracks = sequence_.SelectedTracks();
    WindowTerms terms;
    ALIDADE_RETURN_IF_ERROR(AddTerms(kernel_, tracks, &terms));
    Result<SequenceCovariance> covariance = ComputeSequenceCovariance(
        {sequence_.frames(), terms}, with_covariance, with_covariance && config_.batch.filtering_bound);
    if (!covariance.ok()) {
      return covariance.status();
    }
    report_.covariance = std::move(*covariance);
    return Status::Ok();
  }

  const EstimatorConfig& config_;
  Eigen::Vector3d gravity_W_;
  ObservationKernel kernel_;
  const std::atomic<bool>* stop_;
  BatchSequence& sequence_;
  BatchReport report_;
};

}  // namespace

Result<BatchReport> SolveBatch(const EstimatorConfig& config, const std::atomic<bool>* stop,
                               BatchSequence* sequence) {
  return BatchSolve(config, stop, sequence).Execute();
}

}  // namespace alidade
