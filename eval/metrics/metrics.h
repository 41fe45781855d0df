#pragma once

#include <vector>

#include "eval/metrics/state_pair.h"

namespace alidade {

/// Absolute trajectory error; NaN when there are no pairs.
struct AteResult {
  double pos_m = 0;    ///< rmse
  double ori_deg = 0;  ///< rmse of the rotation angle
  double pos_max_m = 0;
};
[[nodiscard]] AteResult ComputeAte(const std::vector<StatePair>& aligned_pairs);

struct RpeResult {
  double distance_m = 0;
  int count = 0;          ///< sub-trajectories; 0 when the path is too short or the distance not positive
  double pos_rmse_m = 0;  ///< NaN when count is 0
  double ori_rmse_deg = 0;
  std::vector<double> pos_errors_m;  ///< for box plots
};
/// Relative error over sub-trajectories of the given truth path length [m], in the frame of their first pose
/// (Geiger et al. 2012, Zhang and Scaramuzza 2018): T_truth = T_first^-1 T_last against the estimate's. Every
/// pair from which the path still reaches the distance, to half its last step, starts one that ends at the
/// pair nearest to the distance, if that is within 10 % of it. A shorter rest of the path counts for nothing:
/// at the end of every path it would put the error over a shorter distance among those of this one.
[[nodiscard]] std::vector<RpeResult> ComputeRpe(const std::vector<StatePair>& pairs,
                                                const std::vector<double>& distances_m);

/// Path length of the truth through the pairs, first to last [m].
[[nodiscard]] double PathLength(const std::vector<StatePair>& pairs);

}  // namespace alidade
