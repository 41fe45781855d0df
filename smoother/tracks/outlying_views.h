#pragma once

#include <span>
#include <vector>

#include "core/robust.h"
#include "smoother/window/frame_geometry.h"

namespace alidade {

/// Of a track that the gate refuses, SLAM feature or not, the views that contradict the others, poses and the
/// landmark of a SLAM feature held fixed (FindOutlyingObservations). `noise_variance`: at the gate, over that
/// of the observations. False where there are none that suffice, or the landmark is behind a view. True
/// without any where the track passes at the landmark of least squares: a kernel had moved it.
bool FindOutlyingViews(const WindowTrack& track, std::span<const FrameGeometry> geometry,
                       const ChiSquareGate& gate, double noise_variance, std::vector<int>* outlying);

/// For a track whose views have no landmark in front of all of them: FindOutliersOfConsensus.
bool FindOutliersOfConsensus(const WindowTrack& track, std::span<const FrameGeometry> geometry,
                             std::vector<int>* outlying);

}  // namespace alidade
