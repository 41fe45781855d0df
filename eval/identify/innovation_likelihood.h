#pragma once

#include <vector>

#include "core/status.h"
#include "eval/identify/linear_system.h"

namespace alidade {

/// How the innovations of a frame, and of the measurements since the frame before, fit.
struct FrameFit {
  TimeNs stamp_ns = 0;
  double log_likelihood = 0;       ///< less its constant, -rows log(2 pi) / 2
  std::array<double, 4> nis = {};  ///< normalised innovation squared by RowSource
  std::array<int, 4> dof = {};     ///< rows
};

/// Innovation likelihood (Schweppe 1965; Mehra 1970) of a filter on the recorded system whose noises are
/// e^log_scale times the recorded ones:
///
///   log L = -1/2 sum_k (nu_k^T S_k^-1 nu_k + log det S_k),   nu = y - H d,   S = H P H^T + s^2 I
///
/// with s the factor of the rows' own sensor. The rows of rest are used, but do not count: their noise is a
/// choice. One entry a frame. kDiverged: numbers are not finite.
Result<std::vector<FrameFit>> EvaluateInnovations(const LinearSystem& system, const PerNoise& log_scales);

/// Sets the corrections of all updates to those of a filter with the recorded noises. kDiverged as above.
Status FillCorrections(LinearSystem* system);

}  // namespace alidade
