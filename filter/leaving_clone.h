#pragma once

#include <vector>

#include "core/filter_config.h"
#include "filter/filter_state.h"
#include "filter/track_store.h"

namespace alidade {

/// Index of the clone that leaves the window by FilterConfig::clone_policy, or -1 while it is not full.
/// Clones are oldest first and the newest, of frame `serial`, stays. shape_is_known: of the window, with its
/// scale.
///
/// ClonePolicy::kSpread keeps clones whose distances grow with their age. What a memory contains about a
/// clone between two others is then transferred to these with little loss (ConditionClone), and the window is
/// long in time. The oldest leaves when few of the live tracks are as old as the second oldest clone: less
/// than half of them, or a tenth while the window's shape is uncertain, which only a longer baseline mends.
[[nodiscard]] int ChooseLeavingClone(const FilterConfig& filter, const std::vector<Clone>& clones,
                                     const std::vector<Track>& tracks, int serial, bool shape_is_known);

}  // namespace alidade
