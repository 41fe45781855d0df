#pragma once

#include <cstdint>

#include "eval/render/render_hall.h"

namespace alidade {

// What makes a hall harder to see through, added to a hall that stands. Each draws from a stream of its own.

/// Boxes of the size of a person or a cart that swing along horizontal lines on the floor, at the density of
/// config.render. A box whose sweep meets something that stands or leaves the room, or that comes nearer than
/// landmark_min_distance_m to the body, is thrown again, a few times; so there may be fewer.
void ThrowMovingBoxes(const SimulatorConfig& config, const ContinuousTrajectory& trajectory,
                      std::uint64_t seed, Hall* hall);

/// Gives repetitive_share of the faces the texture kMotif, then bare_share of them kPaint.
void VaryTextures(const RenderConfig& config, std::uint64_t seed, Hall* hall);

}  // namespace alidade
