#pragma once

#include "core/robust.h"
#include "gnss/positioning/single_point_options.h"
#include "gnss/positioning/single_point_solution.h"

namespace alidade {

/// Velocity and clock drift from the range rates above the mask, at the solution's position: robust steps, a
/// chi-square gate on each satellite at the epoch's robust scale, robust steps again. Fills velocity, drift,
/// covariance and the satellites' range-rate fields of `solution`; leaves has_velocity false where the rates
/// do not determine one.
void FitVelocity(const EpochMeasurements& epoch, double elevation_mask_rad, const SinglePointOptions& options,
                 const ChiSquareGate& gate, SinglePointSolution* solution);

}  // namespace alidade
