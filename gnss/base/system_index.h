#pragma once

#include <cstddef>

#include "gnss/base/satellite_id.h"

namespace alidade {

/// Place of a system in an array of kGnssSystems.
[[nodiscard]] constexpr std::size_t SystemIndex(GnssSystem system) {
  return static_cast<std::size_t>(system);
}

}  // namespace alidade
