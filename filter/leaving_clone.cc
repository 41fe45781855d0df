#include "filter/leaving_clone.h"

#include <algorithm>
#include <climits>

namespace alidade {
namespace {

// Least share of the live tracks that are as old as the second oldest clone, for the oldest to stay.
constexpr double kOldShare = 0.5;
constexpr double kOldShareUncertain = 0.1;
// The distance of two clones grows with their age and this share of the window, in frames.
constexpr double kEvenShare = 0.6;

/// The newest clones hold views that still wait for their first update: they are not candidates.
int LeastUsedBase(const FilterConfig& filter, const std::vector<Clone>& clones,
                  const std::vector<Track>& tracks) {
  const size_t candidates =
      clones.size() -
      static_cast<size_t>(std::min<int>(filter.min_observations, static_cast<int>(clones.size()) - 1));
  size_t best = 0;
  int best_bases = INT_MAX;
  for (size_t i = 0; i < candidates; ++i) {
    int bases = 0;
    for (const Track& track : tracks) {
      bases += !track.views.empty() && track.views.front().serial == clones[i].serial ? 1 : 0;
    }
    if (bases < best_bases) {
      best_bases = bases;
      best = i;
    }
  }
  return static_cast<int>(best);
}

bool OldestIsUsed(const std::vector<Clone>& clones, const std::vector<Track>& tracks, int serial,
                  bool shape_is_known) {
  int live = 0;
  int old = 0;
  for (const Track& track : tracks) {
    if (track.last_serial == serial) {
      ++live;
      const int first_serial = serial - track.observations + 1;
      old += first_serial <= clones[1].serial ? 1 : 0;
    }
  }
  return old > (shape_is_known ? kOldShare : kOldShareUncertain) * live;
}

/// The clone between two others whose distance is least for its age.
int Densest(const FilterConfig& filter, const std::vector<Clone>& clones, int serial) {
  size_t best = 1;
  double least = 0;
  for (size_t i = 1; i + 1 < clones.size(); ++i) {
    const double distance = (clones[i + 1].serial - clones[i - 1].serial) /
                            (serial - clones[i].serial + kEvenShare * filter.window);
    if (i == 1 || distance < least) {
      least = distance;
      best = i;
    }
  }
  return static_cast<int>(best);
}

}  // namespace

int ChooseLeavingClone(const FilterConfig& filter, const std::vector<Clone>& clones,
                       const std::vector<Track>& tracks, int serial, bool shape_is_known) {
  if (static_cast<int>(clones.size()) <= filter.window) {
    return -1;
  }
  switch (filter.clone_policy) {
    case ClonePolicy::kOldest:
      return 0;
    case ClonePolicy::kAlternate:
      return serial % 2 == 0 ? 0 : static_cast<int>(clones.size()) - 2;
    case ClonePolicy::kSpread:
      return OldestIsUsed(clones, tracks, serial, shape_is_known) ? Densest(filter, clones, serial) : 0;
    case ClonePolicy::kKeepBases:
      break;
  }
  return LeastUsedBase(filter, clones, tracks);
}

}  // namespace alidade
