#include "core/filter_config.h"

#include "core/error_convention_config.h"

namespace alidade {

void FilterConfig::Describe(ConfigVisitor& visitor) {
  DescribeErrorConvention(visitor, "error convention of the state", &error);
  visitor.Enumeration({"landmark", "-", "how the depth at the linearisation point of a track is computed"},
                      &landmark,
                      {{"pose_only_multi", FilterLandmark::kPoseOnlyMulti},
                       {"pose_only_two", FilterLandmark::kPoseOnlyTwo},
                       {"msckf", FilterLandmark::kMsckf}});
  visitor.Enumeration({"update", "-", "when a track updates the state"}, &update,
                      {{"immediate", UpdateTiming::kImmediate},
                       {"delayed_all", UpdateTiming::kDelayedAll},
                       {"at_l", UpdateTiming::kAtL}});
  visitor.Integer(
      {"min_observations", "-", "smallest number of views of a track for an update; L of the paper"},
      &min_observations, 2, 100);
  visitor.Integer({"window", "-", "number of clones in the window"}, &window, 3, 200);
  visitor.Enumeration({"base_reuse", "-", "what happens to the base observation after an immediate update"},
                      &base_reuse,
                      {{"paper", BaseReuse::kPaper},
                       {"inflate", BaseReuse::kInflate},
                       {"limit", BaseReuse::kLimit},
                       {"disjoint", BaseReuse::kDisjoint}});
  visitor.Real({"base_inflation", "-", "factor on the standard deviation of a re-used base observation"},
               &base_inflation, 1, 100);
  visitor.Integer(
      {"max_base_rounds", "-", "largest number of updates that use one base, with base_reuse: limit"},
      &max_base_rounds, 1, 1000);
  visitor.Enumeration(
      {"track_memory", "-", "which landmark information is kept after an update; replaces base_reuse"},
      &track_memory,
      {{"none", TrackMemoryPolicy::kNone},
       {"window", TrackMemoryPolicy::kWindow},
       {"carry", TrackMemoryPolicy::kCarry}});
  visitor.Real({"memory_depth_deviation", "-",
                "largest relative standard deviation of the depth at which a memory starts"},
               &memory_depth_deviation, 1e-3, 1);
  visitor.Boolean(
      {"flush_lost_tracks", "-", "use the remaining observations of a lost track in one last update"},
      &flush_lost_tracks);
  visitor.Enumeration({"clone_policy", "-", "which clone is removed from a full window"}, &clone_policy,
                      {{"oldest", ClonePolicy::kOldest},
                       {"keep_bases", ClonePolicy::kKeepBases},
                       {"alternate", ClonePolicy::kAlternate},
                       {"spread", ClonePolicy::kSpread}});
  visitor.Integer({"refine_iterations", "-",
                   "largest number of Gauss-Newton steps on the landmark; landmark msckf, slam_features and "
                   "track_memory only"},
                  &refine_iterations, 0, 50);
  visitor.Integer({"update_iterations", "-",
                   "largest number of linearisations of a visual update; more than one only where the "
                   "correction is too large for one"},
                  &update_iterations, 1, 50);
  visitor.Enumeration({"update_precision", "-",
                       "precision of the products and factorisations of a visual update while the window's "
                       "shape is known; the covariance is kept in double precision"},
                      &update_precision,
                      {{"double", UpdatePrecision::kDouble}, {"single", UpdatePrecision::kSingle}});
  visitor.Real(
      {"max_direction_deviation", "-",
       "largest relative standard deviation of the direction from the newest camera to the oldest one "
       "at which a track may wait for a better depth; above it, tracks update together, with depths "
       "known to this deviation; 0: tracks always wait"},
      &max_direction_deviation, 0, 10);
  visitor.Boolean({"first_estimates", "-",
                   "evaluate Jacobians at the first estimate of each pose and landmark: with so3xrn yaw then "
                   "stays unobservable"},
                  &first_estimates);
  visitor.Integer({"slam_features", "-",
                   "largest number of SLAM features: long tracks as landmarks of the state, whose "
                   "information outlives the window; 0: none"},
                  &slam_features, 0, 100);
  visitor.Integer(
      {"slam_min_track", "-", "smallest number of observations of a track that becomes a SLAM feature"},
      &slam_min_track, 3, 1000);
  visitor.Real({"slam_max_depth_deviation", "-",
                "largest relative standard deviation of the depth of a track that becomes a SLAM feature"},
               &slam_max_depth_deviation, 1e-4, 1);
}

}  // namespace alidade
