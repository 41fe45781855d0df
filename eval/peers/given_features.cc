#include "eval/peers/given_features.h"

#include <utility>

namespace alidade {

std::vector<VinsFeature> GivenFeatures::Take(const CameraModel& camera, const TrackFrame& frame,
                                             double time_s) {
  std::vector<VinsFeature> features;
  std::map<std::int64_t, Seen> seen;
  for (const TrackObservation& track : frame.observations) {
    VinsFeature feature;
    feature.id = static_cast<int>(track.track_id);
    feature.pixel = track.pixel;
    if (!camera.Unproject(track.pixel, &feature.plane)) {
      continue;
    }
    if (const auto before = seen_.find(track.track_id); before != seen_.end()) {
      feature.velocity = (feature.plane - before->second.plane) / (time_s - before->second.time_s);
      features.push_back(feature);
    }
    seen[track.track_id] = {time_s, feature.plane};
  }
  seen_ = std::move(seen);
  return features;
}

}  // namespace alidade
