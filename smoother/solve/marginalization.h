#pragma once

#include <Eigen/Core>
#include <vector>

#include "smoother/factors/slam_prior.h"
#include "smoother/solve/window_term.h"

namespace alidade {

/// The SLAM features when the oldest frame leaves.
struct SlamChange {
  /// Tracks of the old prior's landmarks (PriorTracks).
  std::vector<const WindowTrack*> before;
  /// Tracks of the new prior's, with anchor and landmark as they are to be: those that stay, and new ones
  /// based in the oldest frame. None is anchored there. A view in the oldest frame goes into the prior. Of
  /// the tracks of `before` that are not among them every view does, and the landmark is eliminated.
  std::vector<const WindowTrack*> after;
  ObservationKernel kernel;
  /// Whether the new prior has a spread (LinearPrior).
  bool relative_to_spread = false;
};

/// Marginalises the oldest frame. The old prior (CarriedPrior), `terms` (the tracks that leave among them)
/// and the landmarks' views (AnchoredViewTerm) are one list of terms. Those that concern the frame, its clock
/// or a landmark that leaves are stacked as whitened rows, linearised at the present states, and QR
/// eliminates what leaves. What remains is the exact Schur complement as a square root; nothing is inverted,
/// so directions without information need no care.
///
/// The new prior is anchored at the present states. The old prior's rows are carried over with their Jacobian
/// unchanged (first estimates): re-linearising them would let a direction that was never observed leak in.
/// With right-invariant errors the gauge directions are the same at every state, so they are then kept
/// exactly. With others they are where frames have first estimates: rows are then taken at these, and a frame
/// that has one keeps it as the origin. A calibration stays. `slam`: the landmarks of the prior.
/// kDiverged: a term is undefined at the present states.
Result<LinearPrior> MarginalizeOldest(const Window& window, const LinearPrior& prior,
                                      const WindowCalibration& calibration, const WindowTerms& terms,
                                      const SlamChange& slam = {});

/// Gives each frame of a new prior its first estimate: where the prior was linearised.
void KeepFirstEstimates(const LinearPrior& prior, Window* window);

}  // namespace alidade
