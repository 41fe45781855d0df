#pragma once

#include <cstddef>
#include <string>

namespace alidade {

/// ", about 4 min left", from the mean time of what is done; empty before 10 s, or when nothing is left.
[[nodiscard]] std::string TimeLeft(double elapsed_s, size_t done, size_t total);

}  // namespace alidade
