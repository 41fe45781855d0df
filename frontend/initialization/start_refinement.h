#pragma once

#include "core/navigation_state.h"
#include "core/status.h"
#include "frontend/initialization/dynamic_window.h"
#include "frontend/initialization/refinement_settings.h"

namespace alidade {

/// States of the window after maximum likelihood, how well they fit and how well they are determined.
struct RefinedStart {
  NavEstimate newest;             ///< yaw 0 and position 0 at this state; covariance with the gauge prior
  std::vector<NavState> states;   ///< of the window, in the world of `newest`
  double relative_scale_std = 0;  ///< of the cameras' distances from the newest one
  double reprojection_chi2 =
      0;                     ///< a degree of freedom of the accepted tracks; 1 when the pixel noise is right
  double inertial_chi2 = 0;  ///< a degree of freedom left by the fit
  double bias_prior_sigma = 0;  ///< |b_a| in deviations of its prior
  int tracks = 0;               ///< accepted
  int rejected_tracks = 0;
  int iterations = 0;
};

/// Levenberg-Marquardt on all states (phi, dp, dv, dbg, dba per frame) of the window: preintegration
/// residuals between frames, reprojection of every track with its landmark eliminated (its 2N-3 rows; the
/// landmark is re-optimised after each step: variable projection), Cauchy weights on observations, priors on
/// the first biases, and on the gauge. Observations whose fit stays bad are dropped (tracks that lose half of
/// theirs, too) and the rest refined again. The covariance is the newest state's marginal of the information
/// matrix at the end, times the reprojection chi-square where that exceeds 1. Error (kDiverged): no
/// minimum within thirty iterations, fewer than eight tracks survive, or the information is singular.
Result<RefinedStart> RefineStart(const DynamicWindow& window, const std::vector<bool>& inlier,
                                 const std::vector<Preintegration>& preintegrations,
                                 const std::vector<NavState>& states, const ImuBias& bias,
                                 const RefinementSettings& settings);

}  // namespace alidade
