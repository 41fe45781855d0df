#pragma once

#include <string>

#include "gnss/formats/ephemeris.h"

namespace alidade {

/// Broadcast ephemerides of made-up constellations over a span of GPST: 24 satellites in 6 planes (GPS), 24
/// in 3 (Galileo, BeiDou MEO, GLONASS), with clocks, group delays and Klobuchar parameters. Reference times
/// are an hour apart (GLONASS half an hour) and consecutive messages of a satellite agree. Every number is as
/// RINEX writes it. `systems`: RINEX letters of GECR.
[[nodiscard]] NavigationData SimulateConstellations(const std::string& systems, TimeNs from_ns, TimeNs to_ns);

}  // namespace alidade
