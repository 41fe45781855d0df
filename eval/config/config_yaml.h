#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config_schema.h"
#include "core/estimator_config.h"
#include "core/status.h"

namespace alidade {

/// Reads a YAML mapping into the values that `describe` lists. A top-level key `base: FILE` (relative to the
/// file) is read first. Strict: an unknown, duplicate, ill-typed or out-of-range key, an octal-looking or
/// non-finite number is kConfig with file:line:column, the value, what was expected and the nearest known
/// key.
Status ReadConfigFile(const std::string& path, const std::function<void(ConfigVisitor&)>& describe);

/// Applies "a.b=value" settings (the flag --set); the message names the setting.
Status ApplySettings(const std::vector<std::string>& settings,
                     const std::function<void(ConfigVisitor&)>& describe);

/// The flag's text "a.b=1,c=[1,2,3]" -> its settings; commas inside brackets do not split.
[[nodiscard]] std::vector<std::string> SplitSettings(std::string_view list);

/// kConfig: a key is given two different values; both are named.
Status CheckSettingsAgree(const std::vector<std::string>& settings);

/// ReadConfigFile + ApplySettings + Validate for an estimator.
Result<EstimatorConfig> LoadEstimatorConfig(const std::string& path,
                                            const std::vector<std::string>& settings);

}  // namespace alidade
