#pragma once

#include <cstddef>
#include <string>

#include "core/status.h"

namespace alidade {

/// No sensor sheet, configuration or plan comes near it.
inline constexpr std::size_t kMaxYamlBytes = std::size_t{128} << 10;

/// Refuses a text on which yaml-cpp, or a walk over its nodes, takes memory or time without bound: larger
/// than kMaxYamlBytes, nested too deeply, with aliases that expand to too many nodes or contain themselves,
/// or with more than one document (yaml-cpp 0.7 reads `,` outside brackets as endless empty documents).
/// Passes over the events of the text without keeping any. Also refuses what is not valid YAML. Errors
/// (`code`): "where:line:column: ...".
Status CheckYamlBounds(const std::string& text, const std::string& where, StatusCode code);

}  // namespace alidade
