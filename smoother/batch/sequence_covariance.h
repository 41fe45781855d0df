#pragma once

#include <vector>

#include "core/status.h"
#include "smoother/batch/sequence_problem.h"

namespace alidade {

/// Covariances from the normal equations of a whole sequence at its present states.
struct SequenceCovariance {
  /// Covariance of every frame's state given all data; canonical chart (phi, dp, dv, dbg, dba).
  std::vector<Matrix15d> smoothed;
  /// Given the data up to the frame alone; empty unless asked for.
  std::vector<Matrix15d> filtered;
  /// g^T H^-1 g, g the gradient and H the Gauss-Newton Hessian over all states and landmarks: the squared
  /// distance to the minimum of the linearised problem in standard deviations. By Cauchy-Schwarz no single
  /// state, nor any combination of states, is farther away than its square root.
  double newton_decrement = 0;
};

/// Block-sparse Cholesky factorisation of the information in time order and selected inversion.
///
/// Front k holds the joint information of the landmarks in sight and the state x_k once every state and track
/// before is eliminated (a track after its last view). To go on, x_{k+1} is joined to it by the terms between
/// both, then E = {x_k, tracks that ended} is eliminated from A = [A_EE A_ES; A_SE A_SS]:
///
///     G = A_SE A_EE^-1,   A_SS <- A_SS - G A_ES.
///
/// Backwards, from the inverse of the last front, the blocks of the inverse inside each front follow
/// (Takahashi et al. 1973; for a chain without landmarks: Rauch, Tung and Striebel 1965):
///
///     P_SE = -P_SS G,   P_EE = A_EE^-1 - G^T P_SE.
///
/// Nothing outside the fronts is formed: with l landmarks in sight cost is O(l^2) and memory O(l) times the
/// tracks that end, a frame. The filtered covariance is the inverse of the front's own last block after
/// elimination of its landmarks: O(l^3) a frame, the dearest part.
///
/// kDiverged: the information of some frame is not positive definite, or a term is undefined (a landmark lies
/// behind a view).
Result<SequenceCovariance> ComputeSequenceCovariance(const SequenceProblem& problem, bool with_covariance,
                                                     bool with_filtered);

}  // namespace alidade
