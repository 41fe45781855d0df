#pragma once

#include <vector>

#include "eval/comparison/comparison.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade {

/// The satellites of a run, sorted, thinned to at most `most` points each; times from the run's first epoch.
[[nodiscard]] std::vector<SkyTrack> MakeSkyTracks(const std::vector<GnssResiduals>& epochs, std::size_t most);

}  // namespace alidade
