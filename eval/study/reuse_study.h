#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/estimator_config.h"
#include "eval/simulation/simulator_config.h"

namespace alidade {

/// A way to use the observations of a track, by the keys of FilterConfig.
struct ReusePolicy {
  std::string name;
  std::string what;  ///< for the table
  std::function<void(FilterConfig*)> apply;
};

/// joint, disjoint, reuse, inflate, limit.
[[nodiscard]] const std::vector<ReusePolicy>& ReusePolicies();

/// Predicted figures of one policy at one window, means over the second half of the frames.
struct ReusePrediction {
  double nees_ratio = 0;  ///< pose NEES over its ideal
  double position_m = 0;  ///< root mean square error of the position
  double orientation_rad = 0;
};

/// Runs the filter of `estimator`, without track memory, with `policy` on the simulation without any noise,
/// from the true state, with a CovarianceAnalysis as observer: the filter assumes the noise of `simulation`
/// and linearises at the true states. Errors: those of Simulate and of the configuration; kDiverged when the
/// run ends early.
Result<ReusePrediction> PredictConsistency(const SimulatorConfig& simulation,
                                           const EstimatorConfig& estimator, const ReusePolicy& policy,
                                           int window, unsigned seed);

}  // namespace alidade
