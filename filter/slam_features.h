#pragma once

#include <vector>

#include "core/filter_config.h"
#include "filter/feature_update.h"
#include "filter/filter_state.h"
#include "filter/track_store.h"

namespace alidade {

/// Long-lived landmarks of the state (FilterConfig::slam_features): which tracks become one, the rows of
/// their later observations, and their end.
///
/// A track enters with the rows of all views it still holds: the 2N-3 landmark-free rows update the state
/// like any other track's, the three rows left over initialise the landmark. Every later observation gives
/// two rows over the newest clone, the landmark and, where it has one, its anchor. So each observation is
/// used once.
class SlamFeatures {
 public:
  SlamFeatures(const FilterConfig& filter, int max_clones);

  /// Forgets what the last frame prepared.
  void Begin();

  /// Makes landmarks of remembered tracks seen in frame `serial` that are long enough, while places are free:
  /// a memory holds the very rows t = R f~ + T x + n that a landmark enters with. One that was carried over a
  /// clone stays a memory: its noise is not its own alone.
  void Promote(int serial, TrackStore* tracks, FilterState* state);
  /// True when the track, seen in frame `serial`, has earned a place in the state and one is free.
  [[nodiscard]] bool IsCandidate(const FilterState& state, const Track& track, int serial) const;
  /// Rows to be filled by FeatureUpdate::Append; dropped again by ReturnRows when it did not.
  LandmarkRows* TakeRows();
  void ReturnRows();
  /// Assigns the rows taken last to block `block` of the update.
  void AssignBlock(size_t block);

  /// Appends the two rows of a landmark's newest observation.
  TrackOutcome Append(const FilterState& state, const Track& track, FeatureUpdate* update);

  /// After the correction: enters the landmark of every block with a positive weight, its rows weighted like
  /// the block's. Tracks are marked as in_state.
  void Enter(const Eigen::Ref<const Eigen::VectorXd>& correction, const std::vector<double>& block_weights,
             FilterState* state, TrackStore* tracks);
  /// Counts the gate's refusals in a row of a track in the state.
  static void CountRefusals(bool accepted, const Track& track, FilterState* state);
  /// Removes landmarks whose track was not observed in frame `serial`, or was rejected twice in a row (such a
  /// track starts again).
  static void RemoveEnded(int serial, TrackStore* tracks, FilterState* state);

 private:
  struct Candidate {
    LandmarkRows rows;
    size_t block = 0;
  };

  FilterConfig filter_;
  [[nodiscard]] bool PlaceIsFree(const FilterState& state) const {
    return state.landmarks().size() + taken_ < static_cast<size_t>(filter_.slam_features);
  }

  std::vector<Candidate> candidates_;  ///< the first taken_ are of this frame
  size_t taken_ = 0;
  LandmarkRows promoted_;
};

}  // namespace alidade
