#pragma once

#include <optional>

#include "gnss/formats/precise_products.h"
#include "gnss/orbits/satellite_state.h"

namespace alidade {

/// Position and velocity of a satellite's centre of mass by Lagrange interpolation of degree 10 (11 nodes
/// around `stamp_ns`, rotated into non-rotating axes), and its clock by linear interpolation plus the
/// relativistic term -2 r.v / c^2. Empty outside the nodes, across a gap in them, or without a clock (nodes
/// of CLK 10 min apart at most, of SP3 30 min). Neglected: the offset of the antenna from the centre of mass,
/// which takes an ANTEX file (0.5 to 3 m towards the Earth, nearly equal within a constellation and then
/// absorbed by the clock).
[[nodiscard]] std::optional<SatelliteState> InterpolatePrecise(const PreciseProducts& products,
                                                               SatelliteId satellite, TimeNs stamp_ns);

}  // namespace alidade
