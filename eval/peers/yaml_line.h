#pragma once

#include <string>

#include "core/format.h"

namespace alidade {

/// A scalar of a settings file of another system, with all digits.
inline std::string YamlLine(const char* key, double value) {
  return Format("%s: %.17g\n", key, value);
}

inline std::string YamlLine(const char* key, int value) {
  return Format("%s: %d\n", key, value);
}

}  // namespace alidade
