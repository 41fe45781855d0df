#include "core/check.h"
#include "core/landmark_reduction.h"
#include "core/outlying_observations.h"
#include "filter/feature_update.h"

// What the search for outlying observations asks of FeatureUpdate.

namespace alidade {

using Eigen::Index;

bool FeatureUpdate::FindOutliers(const FilterState& state, const Track& track, std::vector<int>* outlying) {
  return GatherViews(state, track) && FindOutliersOfConsensus(poses_, observations_, outlying);
}

Eigen::Ref<Eigen::MatrixXd> FeatureUpdate::NoiseMaps(const FilterState& state, const Track& track,
                                                     size_t block) {
  CHECK(GatherViews(state, track) && Linearize(state, points_[block])) << "the block is not of these views";
  const Index rows = 2 * static_cast<Index>(clones_.size());
  auto maps = track_jacobian_.topLeftCorner(rows, rows);
  maps.setIdentity();
  EliminateLandmark(point_jacobian_.topRows(rows), maps, residual_.head(rows));
  return maps.bottomRows(rows - 3);
}

}  // namespace alidade
