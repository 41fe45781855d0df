#pragma once

#include <functional>
#include <string>

#include "core/config_schema.h"

namespace alidade {

/// The resolved configuration as YAML that ReadConfigFile reads back to the same values; with_docs adds unit,
/// range and reason as a comment to every key.
[[nodiscard]] std::string ConfigToYaml(const std::function<void(ConfigVisitor&)>& describe, bool with_docs);

}  // namespace alidade
