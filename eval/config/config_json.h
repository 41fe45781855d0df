#pragma once

#include <functional>
#include <nlohmann/json.hpp>

#include "core/config_schema.h"

namespace alidade {

/// The values that `describe` lists as nested JSON objects, in the order of the description.
[[nodiscard]] nlohmann::ordered_json ConfigToJson(const std::function<void(ConfigVisitor&)>& describe);

}  // namespace alidade
