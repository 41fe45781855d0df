#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/navigation_state.h"
#include "core/robust.h"
#include "core/visual_observation.h"

namespace alidade {

/// Finds the observations of a track that contradict the others, by data snooping (Baarda 1968).
///
/// A track of N observations has R whitened rows without its landmark, y ~ N(0, I). An error d_k of the
/// observation k adds W_k d_k to y, W_k the columns 2k and 2k + 1 of `maps` (R x 2N). Its best estimate
/// lowers |y|^2 by
///
///     T_k = y^T W_k (W_k^T W_k)^-1 W_k^T y,   chi-square with two degrees of freedom without an error.
///
/// The observation with the largest T_k is taken out, until what is left passes the gate. An observation is
/// taken out only where T_k exceeds the gate's quantile, its error probability shared by the N observations.
///
/// True when what is left passes; `outlying` then holds indices in the order they were taken out, at most a
/// third of N: a track most of whose observations contradict its landmark is not of one point. `maps` and
/// `rows` are destroyed.
bool FindOutlyingObservations(const ChiSquareGate& gate, Eigen::Ref<Eigen::MatrixXd> maps,
                              Eigen::Ref<Eigen::VectorXd> rows, std::vector<int>* outlying);

/// For a track whose observations have no landmark in front of all of its views: those that are far from the
/// landmark which most agree on, of the landmarks of all pairs of views. The poses are held fixed.
/// False where fewer than two thirds agree, or all do.
bool FindOutliersOfConsensus(std::span<const Pose> T_WC, std::span<const NormalizedObservation> observations,
                             std::vector<int>* outlying);

/// As kLeastRefusedTracks, for the outlying observations of one frame: q = 0.2. Each frame is tested, and an
/// error of it costs the frame's outliers alone.
inline constexpr int kLeastOutlyingOfFrame = 4;

/// Counts the outlying observations of each frame. Where most of one frame's are outlying, they are right and
/// its pose is wrong.
class FrameOutliers {
 public:
  void Reserve(size_t frames) { counts_.reserve(frames); }
  void Begin(size_t frames);
  void AddSeen(int frame) { ++counts_[static_cast<size_t>(frame)].seen; }
  void AddOutlying(int frame) { ++counts_[static_cast<size_t>(frame)].outlying; }
  /// StateIsSuspect of a frame. `max_share`: VisionConfig::max_gated_share.
  [[nodiscard]] bool AnySuspect(double max_share) const;

 private:
  struct Count {
    int seen = 0;
    int outlying = 0;
  };
  std::vector<Count> counts_;
};

}  // namespace alidade
