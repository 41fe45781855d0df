#include <ceres/solver.h>

// Ends every solve of VINS-Mono or GVINS by iterations alone (linked with --wrap): they limit wall time in
// their initialisation too, and results would depend on the machine.
extern "C" void __real__ZN5ceres5SolveERKNS_6Solver7OptionsEPNS_7ProblemEPNS0_7SummaryE(
    const ceres::Solver::Options&, ceres::Problem*, ceres::Solver::Summary*);
extern "C" void __wrap__ZN5ceres5SolveERKNS_6Solver7OptionsEPNS_7ProblemEPNS0_7SummaryE(
    const ceres::Solver::Options& options, ceres::Problem* problem, ceres::Solver::Summary* summary) {
  constexpr double kNoLimitS = 1e6;
  ceres::Solver::Options unhurried = options;
  unhurried.max_solver_time_in_seconds = kNoLimitS;
  __real__ZN5ceres5SolveERKNS_6Solver7OptionsEPNS_7ProblemEPNS0_7SummaryE(unhurried, problem, summary);
}
