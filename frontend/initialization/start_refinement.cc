#include "frontend/initialization/start_refinement.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "core/imu_propagation.h"
#include "core/yaw_shift.h"
#include "frontend/initialization/start_problem.h"

namespace alidade {
namespace {

using Eigen::Matrix3d;

constexpr int kMaxIterations = 30;
constexpr int kMinRefinedTracks = 8;
// Squared residual of an observation (2 rows) that a good one exceeds once in 1800 times.
constexpr double kMaxSquaredResidual = 15.0;

/// Where a minimisation begins and what it must reach; dampings are relative to the diagonal.
struct Round {
  double first_damping;
  /// The largest damping at which a small gain indicates the minimum. The information of the scale is 1e-10
  /// of a position's own and less, so with more damping a step hardly moves along it.
  double last_damping;
};
// Tracks that do not fit can block the way along the scale: it is sought once they are dropped.
constexpr Round kRough{1e-4, 1};
constexpr Round kSharp{1e-10, 1e-11};
constexpr int kMaxSharpRounds = 3;
constexpr double kLeastDamping = 1e-16;

/// Levenberg-Marquardt until the cost stands still to a fiftieth of a squared deviation; false when it does
/// not within kMaxIterations. Adds to the iterations taken.
bool Minimize(const Round& round, StartProblem* problem, int* iterations) {
  double damping = round.first_damping;
  double cost = problem->Linearize();
  int failures = 0;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    ++*iterations;
    const double candidate_cost = problem->TryStep(damping);
    if (candidate_cost < cost) {
      const bool converged = cost - candidate_cost < 0.02 && damping <= round.last_damping;
      problem->AcceptStep();
      damping = std::max(damping * 0.03, kLeastDamping);
      failures = 0;
      cost = problem->Linearize();
      if (converged) {
        return true;
      }
    } else {
      damping = std::min(damping * 20, 1e6);
      if (++failures == 5) {  // no step lowers it
        return true;
      }
    }
  }
  return false;
}

/// Moves world and covariance so that the newest state has yaw 0 and position 0.
void ApplyGauge(RefinedStart* refined) {
  const Matrix3d& R = refined->newest.nav.R_WB;
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  YawShift gauge{-yaw};
  gauge.p_NW = -(gauge.Rotation() * refined->newest.nav.p_WB);
  for (NavState& state : refined->states) {
    state = gauge * state;
    state.R_WB = so3::Normalize(state.R_WB);
  }
  refined->newest = gauge * refined->newest;
  refined->newest.nav.R_WB = so3::Normalize(refined->newest.nav.R_WB);
}

}  // namespace

Result<RefinedStart> RefineStart(const DynamicWindow& window, const std::vector<bool>& inlier,
                                 const std::vector<Preintegration>& preintegrations,
                                 const std::vector<NavState>& states, const ImuBias& bias,
                                 const RefinementSettings& settings) {
  StartProblem problem(window, inlier, preintegrations, states, bias, settings);
  if (!problem.valid()) {
    return Status::Diverged(
        "moving: the IMU's noise covariance is not positive definite; the four noise densities must be "
        "positive");
  }
  RefinedStart refined;
  bool settled = Minimize(kRough, &problem, &refined.iterations);
  for (int round = 0; settled && round < kMaxSharpRounds; ++round) {
    if (problem.DropAbove(kMaxSquaredResidual) == 0 && round > 0) {
      break;
    }
    settled = Minimize(kSharp, &problem, &refined.iterations);
  }
  if (!settled) {
    return Status::Diverged(Format("moving: no solution after %d iterations", refined.iterations));
  }
  refined.tracks = problem.active_tracks();
  refined.rejected_tracks = static_cast<int>(window.tracks.size()) - refined.tracks;
  if (refined.tracks < kMinRefinedTracks) {
    return Status::Diverged(Format("moving: only %d tracks fit, need %d", refined.tracks, kMinRefinedTracks));
  }
  problem.Linearize();
  refined.reprojection_chi2 = problem.ReprojectionChi2();
  // Worse residuals than announced: the pixel noise was set too low.
  const double variance_factor = std::max(1.0, refined.reprojection_chi2);
  if (!problem.NewestCovariance(variance_factor, &refined.newest.covariance) ||
      !problem.Assess(&refined.relative_scale_std, &refined.inertial_chi2)) {
    return Status::Diverged("moving: the window's information is singular");
  }
  refined.relative_scale_std *= std::sqrt(variance_factor);
  refined.states = problem.states();
  refined.newest.stamp_ns = window.stamps_ns.back();
  refined.newest.nav = problem.states().back();
  refined.newest.bias = problem.biases().back();
  refined.bias_prior_sigma = problem.biases().front().accel.norm() / settings.accel_bias_std_mps2;
  ApplyGauge(&refined);
  return refined;
}

}  // namespace alidade
