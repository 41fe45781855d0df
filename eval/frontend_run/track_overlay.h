#pragma once

#include <string>
#include <vector>

#include "core/track_frame.h"
#include "frontend/tracking/image_reader.h"

namespace alidade {

/// Writes a colour PNG of `image` with the tracks of frames[index] upon it: a dot where each is, a line along
/// where it was in the frames before (ten at most), from blue when it has just begun to red at an age of 50
/// frames. kOutput: cannot be written.
Status WriteTrackOverlay(const GreyImage& image, const std::vector<TrackFrame>& frames, std::size_t index,
                         const std::string& path);

}  // namespace alidade
