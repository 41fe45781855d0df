#pragma once

#include <Eigen/Core>

#include "core/error_convention.h"
#include "smoother/solve/window_term.h"

namespace alidade {

/// What a window knows of its newest frame.
struct NewestEstimate {
  Matrix15d covariance;                    ///< of the state; canonical chart, phi dp dv dbg dba
  Matrix6d clock_covariance;               ///< of the clock, in an aligned window
  Eigen::VectorXd calibration_deviations;  ///< of what of the calibration is estimated
};

/// The same from the whitened rows of `terms` over the frames at their present states, of which QR eliminates
/// the older frames; landmarks must be eliminated within the terms. False when the rows do not determine the
/// unknowns, or a term is undefined there.
bool NewestCovariance(const WindowFrames& frames, const WindowTerms& terms, NewestEstimate* newest);

}  // namespace alidade
