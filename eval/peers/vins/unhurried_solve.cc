#include "eval/peers/vins/unhurried_solve.h"

#include <ceres/solver.h>

namespace alidade::vins {
namespace {

bool& RealTime() {
  static bool real_time = false;
  return real_time;
}

}  // namespace

void SetRealTime(bool real_time) {
  RealTime() = real_time;
}

}  // namespace alidade::vins

// In place of ceres::Solve (linked with --wrap).
extern "C" void __real__ZN5ceres5SolveERKNS_6Solver7OptionsEPNS_7ProblemEPNS0_7SummaryE(
    const ceres::Solver::Options&, ceres::Problem*, ceres::Solver::Summary*);
extern "C" void __wrap__ZN5ceres5SolveERKNS_6Solver7OptionsEPNS_7ProblemEPNS0_7SummaryE(
    const ceres::Solver::Options& options, ceres::Problem* problem, ceres::Solver::Summary* summary) {
  constexpr double kNoLimitS = 1e6;
  ceres::Solver::Options chosen = options;
  if (!alidade::vins::RealTime()) {
    chosen.max_solver_time_in_seconds = kNoLimitS;
  }
  __real__ZN5ceres5SolveERKNS_6Solver7OptionsEPNS_7ProblemEPNS0_7SummaryE(chosen, problem, summary);
}
