#pragma once

#include <cstdint>

namespace alidade {

/// What a degraded estimate lacks (Degradation).
enum class DegradationKind : std::uint8_t {
  kData,   ///< data that it needs are missing, wrong or contradicted by measured positions
  kModel,  ///< a model that holds: noise, camera or lever arm are not as given
};

}  // namespace alidade
