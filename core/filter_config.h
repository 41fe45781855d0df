#pragma once

#include "core/config_schema.h"
#include "core/error_convention.h"

namespace alidade {

enum class FilterLandmark { kPoseOnlyMulti, kPoseOnlyTwo, kMsckf };
enum class UpdateTiming { kImmediate, kDelayedAll, kAtL };
/// What happens to the base observation after an immediate update (docs/pose_only.md).
enum class BaseReuse {
  kPaper,     ///< re-used with its plain noise: double counts, as the paper writes it
  kInflate,   ///< re-used with its standard deviation scaled by base_inflation
  kLimit,     ///< at most max_base_rounds rounds a base
  kDisjoint,  ///< never re-used: a new base each round
};
enum class UpdatePrecision { kDouble, kSingle };
enum class ClonePolicy { kOldest, kKeepBases, kAlternate, kSpread };
/// What an immediate update keeps of the landmark (docs/pose_only.md).
enum class TrackMemoryPolicy {
  kNone,    ///< nothing but the base observation, see BaseReuse
  kWindow,  ///< its three rows, until a clone in them leaves
  kCarry,   ///< its three rows, carried past the window
};

/// The sliding-window invariant filter.
struct FilterConfig {
  ErrorConvention error = ErrorConvention::kRightInvariant;
  FilterLandmark landmark = FilterLandmark::kPoseOnlyMulti;
  UpdateTiming update = UpdateTiming::kImmediate;
  int min_observations = 4;
  int window = 25;
  BaseReuse base_reuse = BaseReuse::kInflate;
  double base_inflation = 2.0;
  int max_base_rounds = 2;
  TrackMemoryPolicy track_memory = TrackMemoryPolicy::kNone;
  double memory_depth_deviation = 0.015;
  bool flush_lost_tracks = true;
  ClonePolicy clone_policy = ClonePolicy::kKeepBases;
  int refine_iterations = 5;
  int update_iterations = 1;
  UpdatePrecision update_precision = UpdatePrecision::kDouble;
  double max_direction_deviation = 0;
  bool first_estimates = false;
  int slam_features = 0;
  int slam_min_track = 10;
  double slam_max_depth_deviation = 0.05;

  void Describe(ConfigVisitor& visitor);
};

}  // namespace alidade
