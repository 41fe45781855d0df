#pragma once

#include <Eigen/Core>
#include <vector>

#include "smoother/factors/gnss_factors.h"
#include "smoother/factors/slam_prior.h"
#include "smoother/tracks/track_system.h"

namespace alidade {

/// The SLAM features when the oldest frame leaves.
struct SlamChange {
  /// Tracks of the old prior's landmarks (PriorTracks).
  std::vector<const WindowTrack*> before;
  /// Tracks of the new prior's, with anchor and landmark as they are to be: those that stay, and new ones
  /// based in the oldest frame. A view in the oldest frame goes into the prior. Of the tracks of `before`
  /// that are not among them every view does, and the landmark is eliminated.
  std::vector<const WindowTrack*> after;
  Pose T_BC;  ///< of a camera that is not calibrated online
  ObservationKernel kernel;
};

/// Marginalises the oldest frame: the old prior, its rest measurement, the IMU factor to the next frame and
/// `vision` (the tracks that leave with it) are stacked as whitened rows, linearised at the present states,
/// and QR eliminates the frame's 15 columns. What remains is the exact Schur complement as a square root;
/// nothing is inverted, so directions without information need no care.
///
/// The new prior is anchored at the present states. The old prior's rows are carried over with their Jacobian
/// unchanged (first estimates): re-linearising them would let a direction that was never observed leak in.
/// With right-invariant errors the gauge directions are the same at every state, so they are then kept
/// exactly. With others they are where frames have first estimates: rows are then taken at these, and a frame
/// that has one keeps it as the origin.
/// Of an aligned window (`gnss`) its epochs and its clock leave with it, tied to the next frame's clock.
/// A calibration that `vision` and `prior` hold stays. `slam`: the landmarks of the prior.
LinearPrior MarginalizeOldest(const Window& window, const LinearPrior& prior, const PoseSystem& vision,
                              const Eigen::Vector3d& gravity_W, const GnssFactorContext* gnss = nullptr,
                              const SlamChange& slam = {});

/// Gives each frame of a new prior its first estimate: where the prior was linearised.
void KeepFirstEstimates(const LinearPrior& prior, Window* window);

}  // namespace alidade
