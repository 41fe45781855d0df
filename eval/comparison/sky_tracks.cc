#include "eval/comparison/sky_tracks.h"

#include <cmath>
#include <map>

#include "core/numbers.h"

namespace alidade {

std::vector<SkyTrack> MakeSkyTracks(const std::vector<GnssResiduals>& epochs, std::size_t most) {
  struct Sum {
    SkyTrack track;
    double squares = 0;
    int used = 0;
    int seen = 0;
  };
  std::map<SatelliteId, Sum> sums;
  const std::size_t stride = (epochs.size() + most - 1) / std::max<std::size_t>(most, 1);
  for (std::size_t k = 0; k < epochs.size(); ++k) {
    for (const SatelliteResidual& s : epochs[k].satellites) {
      Sum& sum = sums[s.satellite];
      ++sum.seen;
      sum.used += s.used ? 1 : 0;
      sum.squares += s.used ? s.residual_m * s.residual_m : 0;
      if (k % stride == 0) {
        sum.track.time_s.push_back(SecondsBetween(epochs.front().stamp_ns, epochs[k].stamp_ns));
        sum.track.azimuth_deg.push_back(s.direction.azimuth_rad * kDegreesPerRadian);
        sum.track.elevation_deg.push_back(s.direction.elevation_rad * kDegreesPerRadian);
        sum.track.residual_m.push_back(s.residual_m);
      }
    }
  }
  std::vector<SkyTrack> tracks;
  for (auto& [satellite, sum] : sums) {
    sum.track.satellite = ToString(satellite);
    sum.track.used_share = static_cast<double>(sum.used) / sum.seen;
    sum.track.rms_m = sum.used > 0 ? std::sqrt(sum.squares / sum.used) : 0;
    tracks.push_back(std::move(sum.track));
  }
  return tracks;
}

}  // namespace alidade
